"""Decodes image files completely, upright, as 8-bit BGR, or refuses them with a reason."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from aerocues.datasets.dataset import Pixels
from aerocues.datasets.fitting import check_settings, equalize_luminance, fitted_size, shrink
from aerocues.datasets.header import Header, read_header, unreadable
from aerocues.datasets.levels import Levels, robust_levels
from aerocues.datasets.stored_values import REDUCED, StoredValues, UndecodableError, stored_values
from aerocues.datasets.tiff import is_first
from aerocues.errors import ImageError
from aerocues.phrases import printable

PIXEL_LIMIT = 250_000_000
"""Images with more pixels are refused, or decoded at reduced size if the format allows it."""

DECODING_VERSION = "1"
"""Part of content keys; increased when decoding gives other pixels for the same file."""

VALUES_VERSION = "1"
"""The same for files with more than 8 bits, several bands or several pages."""


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
    band : int or None
        The band of a multispectral file, or the colour (red, green, blue), to take, from 1 on.
    levels : Levels or None
        The values that become 0 and 255 where the file has more than 8 bits; None: a robust range
        of its own values.

    Raises
    ------
    DatasetError
        If a setting is invalid.
    """

    path: Path
    max_width: int | None = None
    equalize: str = "none"
    pixel_limit: int = PIXEL_LIMIT
    band: int | None = None
    levels: Levels | None = None

    def __post_init__(self) -> None:
        check_settings(self.max_width, self.equalize)

    def read(self) -> Pixels:
        """Decode the image.

        Returns
        -------
        Pixels
            At its final size. Fully transparent (alpha 0) and non-finite pixels, and those with
            GDAL's value of no data, are black and not valid; otherwise alpha is ignored (in 8-bit
            TIFF, partly transparent pixels are blended with black).

        Raises
        ------
        ImageError
            If the file cannot be read, is not an image, is truncated or damaged, or is too large.
        """
        pixels = _eight_bits(self.stored(), self.levels)
        return equalize_luminance(shrink(pixels, self.max_width), self.equalize)

    def stored(self) -> StoredValues:
        """The values in the file, of any type; see `read`."""
        data = self._bytes()
        header = self.header(data)
        try:
            return stored_values(data, header, reduction=self._reduction(header), band=self.band)
        except UndecodableError as error:
            raise ImageError(f"{self._name} cannot be decoded: {error}") from error

    def header(self, data: bytes | None = None) -> Header:
        """The header of the file, or of its content; ImageError if it cannot be read."""
        return read_header(self.path if data is None else data, self._name)

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
        return self.header().size

    def is_gray(self) -> bool:
        """Whether the file has a single channel; False if the header cannot be read.

        A broken file is an error of its pairs, raised by `read`, not of the dataset.
        """
        try:
            header = self.header()
        except ImageError:
            return False
        return header.gray or self.band is not None

    def is_plain(self, data: bytes | None = None) -> bool:
        """Whether every reader sees the same image: 8 bits, one page, all of it content.

        Raises
        ------
        ImageError
            If the header cannot be read.
        """
        data = self._bytes() if data is None else data
        header = self.header(data)
        if header.sample_type != "uint8" or self.band is not None:
            return False
        return all(is_first(data, page) and page.nodata is None for page in header.pages[:1])

    def __getstate__(self) -> dict[str, object]:
        """Without the hash: on another machine the file may differ."""
        return {name: value for name, value in vars(self).items() if name != "_content_key"}

    def content_key(self) -> str:
        """Hash of the bytes of the file and of the settings; ImageError if it cannot be read."""
        return self._content_key

    @cached_property
    def _content_key(self) -> str:
        data = self._bytes()
        digest = hashlib.sha256(data)
        digest.update(f"|{DECODING_VERSION}|{self.max_width}|{self.equalize}".encode())
        digest.update(self._variant(data).encode())
        return digest.hexdigest()

    def _variant(self, data: bytes) -> str:
        """How files that are not plain are read; empty for those that are."""
        try:
            if self.is_plain(data):
                return ""
        except ImageError:
            return ""
        return f"|{VALUES_VERSION}|{self.band}|{self.levels!r}"

    @property
    def _name(self) -> str:
        """The path in messages."""
        return printable(str(self.path))

    def _bytes(self) -> bytes:
        try:
            return self.path.read_bytes()
        except OSError as error:
            raise ImageError(unreadable(self._name, error)) from error

    def _reduction(self, header: Header) -> int:
        """The factor by which the decoder shrinks the image: 1, or more if it is too large."""
        if header.pixels <= self.pixel_limit:
            return 1
        message = (
            f"{self._name} has {header.pixels / 1e6:.0f} megapixels, "
            f"more than {self.pixel_limit / 1e6:.0f}; "
        )
        if header.format != "JPEG":
            raise ImageError(message + "shrink it or cut it into tiles")
        fitting = [n for n in REDUCED if header.pixels / n**2 <= self.pixel_limit]
        if not fitting:
            raise ImageError(message + "cut it into tiles")
        widest = header.size[0] // fitting[0]
        if self.max_width is None or self.max_width > widest:
            raise ImageError(message + f"give `max_width={widest}` or less")
        return fitting[0]


def _eight_bits(stored: StoredValues, levels: Levels | None) -> Pixels:
    values, valid = stored.values, stored.valid
    if values.dtype != np.uint8:
        if not np.issubdtype(values.dtype, np.integer):
            finite = np.isfinite(values)
            finite = finite if finite.ndim == 2 else finite.all(axis=2)
            valid = finite if valid is None else valid & finite
        values = (levels or robust_levels(stored.finite)).scaled(values)
    bgr: Any = values if values.ndim == 3 else cv2.cvtColor(values, cv2.COLOR_GRAY2BGR)
    if valid is None or bool(valid.all()):
        return Pixels(bgr)
    bgr = np.where(valid[..., np.newaxis], bgr, np.uint8(0))
    return Pixels(bgr, valid)
