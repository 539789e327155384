"""Headers of image files, read without decoding pixels: format, size, orientation."""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import IO, Any, TypeVar

from aerocues.datasets.heic import BRANDS, INSTALL, open_heic
from aerocues.datasets.integrity import without_text
from aerocues.datasets.tiff import (
    CMYK,
    MIN_IS_WHITE,
    PALETTE,
    PHOTOMETRIC,
    Page,
    all_pages,
    main_pages,
)
from aerocues.datasets.webp import read_webp
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
_ORIENTATION, _XMP = 274, 700


@dataclass(frozen=True)
class Header:
    """The header of an image file.

    Parameters
    ----------
    format : str
        ``JPEG, PNG, TIFF, BMP, WEBP, PPM`` or ``HEIC``.
    mode : str
        Pillow's name of the pixel format, such as ``RGB`` or ``I;16``.
    stored_width, stored_height : int
        Pixels as stored, before the orientation is applied.
    orientation : int
        EXIF orientation, 1 to 8.
    sample_type : str
        Type of the stored values, such as ``uint8``, ``uint16`` or ``float32``.
    pages : tuple of Page
        Of a TIFF file: those of full size.
    xmp : bytes or str or None
        The XMP packet, if there is one.
    """

    format: str
    mode: str
    stored_width: int
    stored_height: int
    orientation: int = 1
    sample_type: str = "uint8"
    pages: tuple[Page, ...] = ()
    xmp: bytes | str | None = None

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
    def bands(self) -> int:
        """Bands to choose from: pages of the same size, or bands of a page that are no colours."""
        return len(self.pages) if len(self.pages) > 1 else self.pages[0].bands if self.pages else 1

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


def read_tags(file: Path, directories: Sequence[int]) -> tuple[Header, dict[int, dict[int, Any]]]:
    """The header and the EXIF tags of an image file.

    Parameters
    ----------
    file : Path
    directories : sequence of int
        Tags that refer to other directories, such as that of GPS.

    Returns
    -------
    Header
    dict of int to dict
        The tags of each directory, and of the main one as that of 0; empty if there are none.

    Raises ImageError like `read_header`.
    """

    def parse(stream: IO[bytes]) -> tuple[Header, dict[int, dict[int, Any]]]:
        opened = _open(stream)
        # Read while the file is open: TIFF reads its tags on access.
        found = {0: dict(opened.exif)}
        found |= {number: dict(opened.exif.get_ifd(number)) for number in directories}
        return _header(opened, stream), found

    return _read(file, str(file), parse)


_Result = TypeVar("_Result")


def _read(file: Path | bytes, name: str, parse: Callable[[IO[bytes]], _Result]) -> _Result:
    try:
        with (
            BytesIO(file) if isinstance(file, bytes) else file.open("rb") as stream,
            warnings.catch_warnings(),
        ):
            warnings.simplefilter("ignore")  # of Pillow: what matters is told when it is decoded
            return parse(stream)
    except OSError as error:
        if isinstance(file, Path) and error.errno is not None:
            raise ImageError(unreadable(name, error)) from error
        raise _not_an_image(name) from error
    except ImportError as error:
        raise ImageError(f"{name} is a HEIC file: {INSTALL}") from error
    except Exception as error:  # Pillow's readers may raise anything on bytes that are damaged
        raise _not_an_image(name) from error


def unreadable(name: str, error: OSError) -> str:
    """The message for a file that the operating system cannot read."""
    reason = error.strerror or str(error)
    return f"cannot read {name}: {reason}; check that it exists and is readable"


def _not_an_image(name: str) -> ImageError:
    return ImageError(
        f"{name} is not a readable image (JPEG, PNG, TIFF, BMP, WebP or PPM/PGM); copy it again, "
        "convert it, or remove it from the folder"
    )


@dataclass(frozen=True)
class _Opened:
    """What Pillow, or an own reader, finds before any pixel."""

    format: str
    mode: str
    size: tuple[int, int]
    exif: Any
    pages: tuple[Page, ...] = ()
    xmp: Any = None


def _parse(stream: IO[bytes]) -> Header:
    return _header(_open(stream), stream)


def _header(opened: _Opened, stream: IO[bytes]) -> Header:
    orientation = 1 if opened.format == "HEIC" else opened.exif.get(_ORIENTATION, 1)
    if not isinstance(orientation, int) or not 1 <= orientation <= 8:
        orientation = 1
    sample_type = (
        opened.pages[0].sample_type if opened.pages else _sample_type(stream, opened.format)
    )
    xmp = opened.xmp or opened.exif.get(_XMP)
    return Header(
        *(opened.format, opened.mode, *opened.size, orientation, sample_type, opened.pages),
        xmp=xmp if isinstance(xmp, bytes | str) else None,
    )


def _open(stream: IO[bytes]) -> _Opened:
    """Format, size and EXIF data, after reading the header only."""
    from PIL import Image

    name = _format(stream.read(16))
    stream.seek(0)
    if name == "TIFF":
        return _open_tiff(stream)
    if name in ("WEBP", "HEIC"):
        image: Any = Image.Image()
        mode, size, image.info = read_webp(stream) if name == "WEBP" else _read_heic(stream)
    else:
        image = _opened_by_pillow(name, stream)
        mode, size = image.mode, image.size
    # Not image.getexif(): for PNG it decodes all pixels to find EXIF behind them.
    return _Opened(name, mode, size, Image.Image.getexif(image), xmp=image.info.get("xmp"))


def _read_heic(stream: IO[bytes]) -> tuple[str, tuple[int, int], dict[str, Any]]:
    """Pixel format, size and metadata; the image is turned upright when it is decoded."""
    image = open_heic(stream.read())
    return image.mode, image.size, {"exif": image.info.get("exif")}


def _opened_by_pillow(name: str, stream: IO[bytes]) -> Any:
    # Readers are called directly: Image.open refuses images above a size in global state, and opens
    # some camera JPEGs as a series of images.
    try:
        return _reader(name)(stream)
    except ValueError:
        if name != "PNG":
            raise
        # Pillow has a limit of compressed text, which is of no use here.
        stream.seek(0)
        return _reader(name)(BytesIO(without_text(stream.read())))


def _open_tiff(stream: IO[bytes]) -> _Opened:
    from PIL import Image

    pages = main_pages(all_pages(stream))
    exif: Any = Image.Exif()
    stream.seek(0)
    start = stream.read(4)
    exif.endian, exif.bigtiff = "<" if start[:2] == b"II" else ">", b"+" in start
    exif.load_from_fp(stream, pages[0].offset)
    return _Opened("TIFF", _mode(pages[0]), pages[0].size, exif, tuple(pages))


def _mode(page: Page) -> str:
    """Pillow's name of the pixel format, as far as it matters here."""
    photometric = page.number(PHOTOMETRIC, 1)
    if photometric == CMYK and page.sample_type == "uint8":
        return "CMYK"
    if photometric in (MIN_IS_WHITE, 1):
        return "L"
    return "P" if photometric == PALETTE else "RGB"


def _sample_type(stream: IO[bytes], name: str) -> str:
    """Pillow reads 16-bit colours as if they had 8 bits."""
    stream.seek(0)
    start = stream.read(512)
    if name == "PNG":
        return "uint16" if start[24] == 16 else "uint8"
    if name == "PPM" and start[:2] in (b"P2", b"P3", b"P5", b"P6"):
        numbers = re.sub(rb"#[^\n]*", b"", start[2:]).split()
        return "uint16" if int(numbers[2]) > 255 else "uint8"
    return "uint8"


def _format(start: bytes) -> str:
    for name, signatures in _SIGNATURES:
        if start.startswith(signatures) and (name != "WEBP" or start[8:12] == b"WEBP"):
            return name
    if start[4:8] == b"ftyp" and start[8:12] in BRANDS:
        return "HEIC"
    raise ValueError("unknown signature")


def _reader(name: str) -> Any:
    from PIL import (
        BmpImagePlugin,
        JpegImagePlugin,
        PngImagePlugin,
        PpmImagePlugin,
    )

    readers = {
        "JPEG": JpegImagePlugin.JpegImageFile,
        "PNG": PngImagePlugin.PngImageFile,
        "BMP": BmpImagePlugin.BmpImageFile,
        "PPM": PpmImagePlugin.PpmImageFile,
    }
    return readers[name]
