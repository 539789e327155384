"""Decodes image files completely, upright, as 8-bit BGR, or refuses them with a reason."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.dataset import Pixels
from aerocues.datasets.fitting import check_settings, equalize_luminance, fitted_size, shrink
from aerocues.datasets.header import Header, read_header, unreadable
from aerocues.datasets.integrity import find_damage
from aerocues.errors import ImageError

PIXEL_LIMIT = 250_000_000
"""Images with more pixels are refused, or decoded at reduced size if the format allows it."""

DECODING_VERSION = "1"
"""Part of content keys; increased when decoding gives other pixels for the same file."""

_SENSOR_WHITES = tuple(2**bits - 1 for bits in (8, 10, 12, 14, 16))
_REDUCED = {
    2: cv2.IMREAD_REDUCED_COLOR_2,
    4: cv2.IMREAD_REDUCED_COLOR_4,
    8: cv2.IMREAD_REDUCED_COLOR_8,
}


@dataclass(frozen=True)
class FileSource:
    """An image file, and how to read it.

    Parameters
    ----------
    path : Path
        JPEG, PNG, TIFF, BMP, WebP or PPM/PGM file; gray, colour, palette, with or without alpha,
        8 or 16 bits or floating point.
    max_width : int or None
        Wider images are shrunk to this width in pixels (after the EXIF orientation is applied).
    equalize : str
        ``none``, ``histogram`` or ``clahe``.
    pixel_limit : int
        Images with more pixels are refused.

    Raises
    ------
    DatasetError
        If a setting is invalid.
    """

    path: Path
    max_width: int | None = None
    equalize: str = "none"
    pixel_limit: int = PIXEL_LIMIT

    def __post_init__(self) -> None:
        check_settings(self.max_width, self.equalize)

    def read(self) -> Pixels:
        """Decode the image.

        Returns
        -------
        Pixels
            At its final size. Fully transparent (alpha 0) and non-finite pixels are black and not
            valid; otherwise alpha is ignored (in 8-bit TIFF, partly transparent pixels are blended
            with black).

        Raises
        ------
        ImageError
            If the file cannot be read, is not an image, is truncated or damaged, or is too large.
        """
        data = self._bytes()
        header = read_header(data, str(self.path))
        factor = self._reduction(header)
        damage = find_damage(data, header.format)
        decoded = None if damage else _decode(data, header, factor)
        if decoded is None:
            reason = damage or "it is truncated, damaged or of an unsupported kind"
            raise ImageError(f"{self.path} cannot be decoded: {reason}; copy or export it again")
        pixels = _eight_bits(_oriented(decoded, header))
        return equalize_luminance(shrink(pixels, self.max_width), self.equalize)

    def size(self) -> tuple[int, int]:
        """Width and height of the image that `read` returns, from the header alone.

        Raises
        ------
        ImageError
            If the header cannot be read.
        """
        return fitted_size(self.original_size(), self.max_width)

    def original_size(self) -> tuple[int, int]:
        """Width and height of the image in the file, upright."""
        return read_header(self.path, str(self.path)).size

    def is_gray(self) -> bool:
        """Whether the file has a single channel; False if the header cannot be read.

        A broken file is an error of its pairs, raised by `read`, not of the dataset.
        """
        try:
            return read_header(self.path, str(self.path)).gray
        except ImageError:
            return False

    def __getstate__(self) -> dict[str, object]:
        """Without the hash: on another machine the file may differ."""
        return {name: value for name, value in vars(self).items() if name != "_content_key"}

    def content_key(self) -> str:
        """Hash of the bytes of the file and of the settings; ImageError if it cannot be read."""
        return self._content_key

    @cached_property
    def _content_key(self) -> str:
        digest = hashlib.sha256(self._bytes())
        digest.update(f"|{DECODING_VERSION}|{self.max_width}|{self.equalize}".encode())
        return digest.hexdigest()

    def _bytes(self) -> bytes:
        try:
            return self.path.read_bytes()
        except OSError as error:
            raise ImageError(unreadable(str(self.path), error)) from error

    def _reduction(self, header: Header) -> int:
        """The factor by which the decoder shrinks the image: 1, or more if it is too large."""
        if header.pixels <= self.pixel_limit:
            return 1
        message = (
            f"{self.path} has {header.pixels / 1e6:.0f} megapixels, "
            f"more than {self.pixel_limit / 1e6:.0f}; "
        )
        if header.format != "JPEG":
            raise ImageError(message + "shrink it or cut it into tiles")
        fitting = [n for n in _REDUCED if header.pixels / n**2 <= self.pixel_limit]
        if not fitting:
            raise ImageError(message + "cut it into tiles")
        widest = header.size[0] // fitting[0]
        if self.max_width is None or self.max_width > widest:
            raise ImageError(message + f"give `max_width={widest}` or less")
        return fitting[0]


def _decode(data: bytes, header: Header, factor: int) -> Any:
    """Pixels as stored, decoded by OpenCV; None if that fails."""
    if header.format == "JPEG":
        flag = _REDUCED.get(factor, cv2.IMREAD_COLOR) | cv2.IMREAD_IGNORE_ORIENTATION
    elif header.mode == "CMYK":  # its four channels would be read as colour and alpha
        flag = cv2.IMREAD_COLOR
    else:
        flag = cv2.IMREAD_UNCHANGED
    try:
        return cv2.imdecode(np.frombuffer(data, np.uint8), flag)
    except cv2.error:
        return None


def _oriented(stored: Any, header: Header) -> Any:
    """Apply the EXIF orientation (OpenCV does so itself for TIFF)."""
    if header.format == "TIFF":
        return stored
    if header.orientation >= 5:
        stored = cv2.transpose(stored)
    # After the transposition: 2, 7, 3, 6 are mirrored left-right; 4, 3, 7, 8 upside down.
    if header.orientation in (2, 3, 6, 7):
        stored = cv2.flip(stored, 1)
    if header.orientation in (3, 4, 7, 8):
        stored = cv2.flip(stored, 0)
    return stored


def _eight_bits(decoded: NDArray[Any]) -> Pixels:
    values, valid = _split_alpha(decoded)
    if values.dtype == np.uint16:
        values = cv2.convertScaleAbs(values, alpha=255.0 / _full_scale(values))
    elif values.dtype != np.uint8:
        values, finite = _stretched(values)
        valid = finite if valid is None else valid & finite
    bgr: Any = values if values.ndim == 3 else cv2.cvtColor(values, cv2.COLOR_GRAY2BGR)
    if valid is None or bool(valid.all()):
        return Pixels(bgr)
    bgr = np.where(valid[..., np.newaxis], bgr, np.uint8(0))
    return Pixels(bgr, valid)


def _split_alpha(decoded: NDArray[Any]) -> tuple[Any, NDArray[np.bool_] | None]:
    if decoded.ndim == 2:
        return decoded, None
    channels = decoded.shape[2]
    if channels in (1, 2):
        return np.ascontiguousarray(decoded[..., 0]), decoded[..., 1] > 0 if channels == 2 else None
    valid = decoded[..., 3] > 0 if channels == 4 else None
    return np.ascontiguousarray(decoded[..., :3]), valid


def _full_scale(values: NDArray[np.uint16]) -> int:
    """White level of a 16-bit image: that of the smallest bit depth (8 to 16) that contains it.

    Cameras store 10, 12 or 14 bits in 16-bit files, which would be nearly black if divided by 256.
    """
    highest = int(values.max())
    return next(white for white in _SENSOR_WHITES if highest <= white)


def _stretched(values: NDArray[Any]) -> tuple[NDArray[np.uint8], NDArray[np.bool_]]:
    """Floating point and wide integers have no white level: scaled from minimum to maximum."""
    wide = values.astype(np.float32)
    finite: NDArray[np.bool_] = np.isfinite(wide)
    low, high = (wide[finite].min(), wide[finite].max()) if finite.any() else (0.0, 1.0)
    scaled = (np.where(finite, wide, low) - low) * (255.0 / max(float(high - low), 1e-12))
    usable: NDArray[np.bool_] = finite if finite.ndim == 2 else np.all(finite, axis=2)
    return np.rint(scaled).astype(np.uint8), usable
