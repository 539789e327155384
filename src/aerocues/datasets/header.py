"""Headers of image files, read without decoding pixels: format, size, orientation."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import IO, Any, TypeVar

from aerocues.errors import ImageError

SUFFIXES = frozenset(
    {".jpg", ".jpeg", ".png", ".tif", ".tiff", ".bmp", ".webp", ".ppm", ".pgm", ".pnm"}
)
"""Suffixes (in any case) of image files."""

_SIGNATURES = (
    ("JPEG", (b"\xff\xd8\xff",)),
    ("PNG", (b"\x89PNG\r\n\x1a\n",)),
    ("TIFF", (b"II*\x00", b"MM\x00*", b"II+\x00", b"MM\x00+")),
    ("BMP", (b"BM",)),
    ("WEBP", (b"RIFF",)),
    ("PPM", (b"P1", b"P2", b"P3", b"P4", b"P5", b"P6")),
)
_GRAY_MODES = frozenset({"1", "L", "LA", "La", "F"})
_ORIENTATION = 274
_TIFF_WIDTH, _TIFF_HEIGHT = 256, 257


@dataclass(frozen=True)
class Header:
    """The header of an image file.

    Parameters
    ----------
    format : str
        ``JPEG, PNG, TIFF, BMP, WEBP`` or ``PPM``.
    mode : str
        Pillow's name of the pixel format, such as ``RGB`` or ``I;16``.
    stored_width, stored_height : int
        Pixels as stored, before the orientation is applied.
    orientation : int
        EXIF orientation, 1 to 8.
    """

    format: str
    mode: str
    stored_width: int
    stored_height: int
    orientation: int = 1

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the upright image."""
        if self.orientation >= 5:
            return self.stored_height, self.stored_width
        return self.stored_width, self.stored_height

    @property
    def pixels(self) -> int:
        """Number of pixels."""
        return self.stored_width * self.stored_height

    @property
    def gray(self) -> bool:
        """Whether there is only one channel, apart from alpha."""
        return self.mode in _GRAY_MODES or self.mode.startswith("I")


def read_header(file: Path | bytes, name: str) -> Header:
    """Read the header of an image file from its path or content.

    Raises
    ------
    ImageError
        If the file cannot be opened or is not an image of a known format; the message has `name`.
    """
    return _read(file, name, _parse)


def read_exif_directory(file: Path, directory: int) -> dict[int, Any]:
    """The tags of one directory in the EXIF data of an image file; empty if there is none.

    Raises ImageError like `read_header`, and if the EXIF data are broken.
    """

    def parse(stream: IO[bytes]) -> dict[int, Any]:
        # Read while the file is open: TIFF reads its tags on access.
        return dict(_exif(_open(stream)[1]).get_ifd(directory))

    return _read(file, str(file), parse)


_Result = TypeVar("_Result")


def _read(file: Path | bytes, name: str, parse: Callable[[IO[bytes]], _Result]) -> _Result:
    try:
        with BytesIO(file) if isinstance(file, bytes) else file.open("rb") as stream:
            return parse(stream)
    except OSError as error:
        if isinstance(file, Path) and error.errno is not None:
            raise ImageError(unreadable(name, error)) from error
        raise _not_an_image(name) from error
    except (SyntaxError, ValueError, KeyError, IndexError, TypeError, EOFError) as error:
        raise _not_an_image(name) from error


def unreadable(name: str, error: OSError) -> str:
    """The message for a file that the operating system cannot read."""
    reason = error.strerror or str(error)
    return f"cannot read {name}: {reason}; check that it exists and is readable"


def _not_an_image(name: str) -> ImageError:
    return ImageError(
        f"{name} is not a readable image (JPEG, PNG, TIFF, BMP, WebP or PPM/PGM); convert it, or "
        "remove it from the folder"
    )


def _parse(stream: IO[bytes]) -> Header:
    name, image = _open(stream)
    if name == "TIFF":
        width, height = image.tag_v2[_TIFF_WIDTH], image.tag_v2[_TIFF_HEIGHT]
        orientation = image.tag_v2.get(_ORIENTATION, 1)
    else:
        width, height = image.size
        orientation = _exif(image).get(_ORIENTATION, 1)
    valid = isinstance(orientation, int) and 1 <= orientation <= 8
    return Header(name, image.mode, int(width), int(height), orientation if valid else 1)


def _open(stream: IO[bytes]) -> tuple[str, Any]:
    """The format and Pillow's reader, after reading the header only."""
    name = _format(stream.read(16))
    stream.seek(0)
    # Readers are called directly: Image.open refuses images above a size in global state, and opens
    # some camera JPEGs as a series of images.
    return name, _reader(name)(stream)


def _exif(image: Any) -> Any:
    from PIL import Image

    # Not image.getexif(): for PNG it decodes all pixels to find EXIF behind them.
    return Image.Image.getexif(image)


def _format(start: bytes) -> str:
    for name, signatures in _SIGNATURES:
        if start.startswith(signatures) and (name != "WEBP" or start[8:12] == b"WEBP"):
            return name
    raise ValueError("unknown signature")


def _reader(name: str) -> Any:
    from PIL import (
        BmpImagePlugin,
        JpegImagePlugin,
        PngImagePlugin,
        PpmImagePlugin,
        TiffImagePlugin,
        WebPImagePlugin,
    )

    readers = {
        "JPEG": JpegImagePlugin.JpegImageFile,
        "PNG": PngImagePlugin.PngImageFile,
        "TIFF": TiffImagePlugin.TiffImageFile,
        "BMP": BmpImagePlugin.BmpImageFile,
        "WEBP": WebPImagePlugin.WebPImageFile,
        "PPM": PpmImagePlugin.PpmImageFile,
    }
    return readers[name]
