"""Decodes image files to the values that are stored in them, upright, with what is not content."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.decoder_messages import with_messages
from aerocues.datasets.header import Header
from aerocues.datasets.heic import decode_heic
from aerocues.datasets.integrity import find_complaint, find_damage
from aerocues.datasets.tiff import (
    DECODABLE_SAMPLES,
    MIN_IS_WHITE,
    PALETTE,
    PHOTOMETRIC,
    Page,
    alone,
    is_first,
    one_band,
    summed,
)

REDUCED = {
    2: cv2.IMREAD_REDUCED_COLOR_2,
    4: cv2.IMREAD_REDUCED_COLOR_4,
    8: cv2.IMREAD_REDUCED_COLOR_8,
}
"""How OpenCV decodes JPEG at a fraction of its size."""
UNKNOWN_DAMAGE = "it is truncated, damaged or of an unsupported kind; copy or export it again"
COLOURS = 3


@dataclass(frozen=True, eq=False)
class StoredValues:
    """The values of an image as they are stored.

    Parameters
    ----------
    values : (H, W) or (H, W, 3)
        Gray, or blue, green and red; any type.
    valid : (H, W) bool or None
        False where there is no content: transparent, not finite, or GDAL's value of no data.
    """

    values: NDArray[Any]
    valid: NDArray[np.bool_] | None = None

    @property
    def finite(self) -> NDArray[Any]:
        """The finite values of valid pixels, (N,)."""
        content = (self.values if self.valid is None else self.values[self.valid]).ravel()
        whole = np.issubdtype(content.dtype, np.integer)
        return content if whole else content[np.isfinite(content)]


class UndecodableError(Exception):
    """Why a file cannot be decoded, and what to do."""


def stored_values(
    data: bytes, header: Header, *, reduction: int = 1, band: int | None = None
) -> StoredValues:
    """Decode a file.

    Parameters
    ----------
    data : bytes
    header : Header
    reduction : int
        1, or a key of `REDUCED` for JPEG.
    band : int, optional
        The band or colour (red, green, blue) to take, from 1 on.

    Raises
    ------
    UndecodableError
    """
    if damage := find_damage(data, header.format):
        raise UndecodableError(f"{damage}; copy or export it again")
    check_band(header, band)
    if header.format == "TIFF":
        return _from_tiff(data, header, band)
    if header.format == "HEIC":
        return _one_colour(_masked(_decoded_heic(data)), band)
    if header.format == "JPEG":
        flag = REDUCED.get(reduction, cv2.IMREAD_COLOR) | cv2.IMREAD_IGNORE_ORIENTATION
    else:
        flag = cv2.IMREAD_UNCHANGED
    return _one_colour(_masked(_oriented(_decoded(data, flag), header)), band)


def check_band(header: Header, band: int | None) -> None:
    """Raise UndecodableError where a band must be chosen, or is not there."""
    if header.bands > 1 and band is None:
        raise UndecodableError(
            f"it has {header.bands} bands; choose one with `band`, from 1 to {header.bands}"
        )
    count = max(header.bands, 1 if header.gray else COLOURS)
    if header.pages and header.pages[0].colours_by_band:
        count = header.pages[0].samples
    if band is not None and not 1 <= band <= count:
        one = "band" if count == 1 else "bands"
        raise UndecodableError(f"it has {count} {one} and no band {band}; give another `band`")


def _decoded(data: bytes, flag: int) -> Any:
    """What OpenCV makes of a file, if it does not complain."""
    encoded = np.frombuffer(data, np.uint8)
    try:
        found, written = with_messages(lambda: cv2.imdecode(encoded, flag))
    except cv2.error:
        found, written = None, b""
    if complaint := find_complaint(written, data):
        raise UndecodableError(f"{complaint}; copy or export it again")
    if found is None:
        raise UndecodableError(UNKNOWN_DAMAGE)
    return found


def _decoded_heic(data: bytes) -> NDArray[Any]:
    try:
        return decode_heic(data)
    except (ValueError, RuntimeError, EOFError, OSError) as error:
        raise UndecodableError(f"it is damaged ({error}); copy or export it again") from error


def _oriented(stored: Any, header: Header) -> Any:
    """Apply the EXIF orientation (OpenCV does so itself for TIFF)."""
    if header.orientation >= 5:
        stored = cv2.transpose(stored)
    # After the transposition: 2, 7, 3, 6 are mirrored left-right; 4, 3, 7, 8 upside down.
    if header.orientation in (2, 3, 6, 7):
        stored = cv2.flip(stored, 1)
    if header.orientation in (3, 4, 7, 8):
        stored = cv2.flip(stored, 0)
    return stored


def _from_tiff(data: bytes, header: Header, band: int | None) -> StoredValues:
    several = len(header.pages) > 1
    page = header.pages[(band or 1) - 1 if several else 0]
    if damage := page.damage(data):
        raise UndecodableError(f"{damage}; copy or export it again")
    if not several and (page.bands > 1 or page.colours_by_band):
        return _finished(_by_band(data, header, page, band), page)
    content = data if is_first(data, page) else alone(data, page)
    # The four channels of CMYK would be read as colour and alpha.
    flag = cv2.IMREAD_COLOR if header.mode == "CMYK" else cv2.IMREAD_UNCHANGED
    decoded = _decoded(content, flag)
    return _one_colour(_finished(_masked(decoded), page), None if several else band)


def _by_band(data: bytes, header: Header, page: Page, band: int | None) -> StoredValues:
    """A band, or the colours, each by itself."""
    order = (2, 1, 0) if band is None else (band - 1,)
    planes = [_oriented(_one_of_many(data, page, each), header) for each in order]
    valid = None
    if page.has_alpha and page.samples == DECODABLE_SAMPLES:
        valid = _oriented(_one_of_many(data, page, DECODABLE_SAMPLES - 1), header) > 0
    return StoredValues(planes[0] if len(planes) == 1 else np.dstack(planes), valid)


def _one_of_many(data: bytes, page: Page, band: int) -> NDArray[Any]:
    """A band of several, which OpenCV does not decode, or takes for colours."""
    rewritten = one_band(data, page, band)
    if rewritten is None:
        raise UndecodableError(
            "its bands are stored in an unsupported way; convert it: gdal_translate -co "
            "INTERLEAVE=BAND"
        )
    content, stride = rewritten
    values: NDArray[Any] = _decoded(content, cv2.IMREAD_UNCHANGED)
    if stride == 1:
        return values
    together = values.reshape(values.shape[0], -1, stride)
    return np.ascontiguousarray(summed(together, page)[..., band])


def _channel(decoded: NDArray[Any], band: int) -> NDArray[Any]:
    """Red, green or blue, which OpenCV puts in the other order."""
    return np.ascontiguousarray(decoded[..., COLOURS - band])


def _masked(decoded: NDArray[Any]) -> StoredValues:
    """Without alpha, which tells what is valid."""
    if decoded.ndim == 2:
        return StoredValues(decoded)
    channels = decoded.shape[2]
    if channels in (1, 2):
        valid = decoded[..., 1] > 0 if channels == 2 else None
        return StoredValues(np.ascontiguousarray(decoded[..., 0]), valid)
    valid = decoded[..., 3] > 0 if channels == 4 else None
    return StoredValues(np.ascontiguousarray(decoded[..., :3]), valid)


def _one_colour(stored: StoredValues, band: int | None) -> StoredValues:
    if band is None or stored.values.ndim == 2:
        return stored
    return replace(stored, values=_channel(stored.values, band))


def _finished(stored: StoredValues, page: Page) -> StoredValues:
    """With what the tags say of pixels without content, and of which end is white."""
    values, valid = stored.values, stored.valid
    if page.nodata is not None and page.number(PHOTOMETRIC) != PALETTE:
        content = values != page.nodata
        content = content if content.ndim == 2 else content.any(axis=2)
        valid = content if valid is None else valid & content
    # OpenCV inverts what has 8 bits or less itself.
    if page.number(PHOTOMETRIC, 1) == MIN_IS_WHITE and values.dtype != np.uint8:
        whole = np.issubdtype(values.dtype, np.unsignedinteger)
        values = np.iinfo(values.dtype).max - values if whole else -values
    return StoredValues(values, valid)
