"""Resizes decoded images and normalises their illumination."""

from __future__ import annotations

from numbers import Integral
from typing import Any, Literal, get_args

import cv2
import numpy as np
from numpy.typing import NDArray

from aerocues.arguments import check_choice
from aerocues.datasets.dataset import Pixels
from aerocues.errors import ArgumentError

Equalization = Literal["none", "histogram", "clahe"]
EQUALIZATIONS: tuple[str, ...] = get_args(Equalization)

SMALLEST = 16
_CLAHE_CLIP_LIMIT = 2.0
_CLAHE_TILES = (8, 8)


def check_settings(max_width: int | None, equalize: str) -> None:
    """Raise ArgumentError unless the size and the equalisation are valid."""
    if max_width is not None and (not isinstance(max_width, Integral) or max_width < SMALLEST):
        raise ArgumentError(
            f"`max_width` must be {SMALLEST} pixels or more, or 0 for images as they are, got "
            f"{max_width!r}"
        )
    check_choice("equalize", equalize, EQUALIZATIONS)


def fitted_size(size: tuple[int, int], max_width: int | None) -> tuple[int, int]:
    """Width and height after shrinking to `max_width`; never enlarged."""
    width, height = size
    if max_width is None or width <= max_width:
        return width, height
    return max_width, max(1, round(height * max_width / width))


def shrink(pixels: Pixels, max_width: int | None) -> Pixels:
    """Shrink to `max_width` by area averaging; only completely valid pixels stay valid."""
    height, width = pixels.bgr.shape[:2]
    size = fitted_size((width, height), max_width)
    return pixels if size == (width, height) else resize(pixels, size)


def resize(pixels: Pixels, size: tuple[int, int]) -> Pixels:
    """Resize to (width, height): area averaging if it shrinks, bilinear if it grows."""
    interpolation = cv2.INTER_AREA if size[0] < pixels.bgr.shape[1] else cv2.INTER_LINEAR
    bgr: Any = cv2.resize(pixels.bgr, size, interpolation=interpolation)
    if pixels.valid is None:
        return Pixels(bgr)
    mask: Any = cv2.resize(pixels.valid.astype(np.uint8) * 255, size, interpolation=interpolation)
    return Pixels(bgr, mask == 255)


def equalize_luminance(pixels: Pixels, how: str) -> Pixels:
    """Normalise the illumination: ``none``, ``histogram`` or ``clahe`` (clip limit 2, 8x8 tiles).

    Only the luminance (Y of YCrCb) changes; colours keep their hue.
    """
    if how == "none":
        return pixels
    luminance: Any = cv2.cvtColor(pixels.bgr, cv2.COLOR_BGR2YCrCb)
    plane = np.ascontiguousarray(luminance[..., 0])
    luminance[..., 0] = _equalized(plane, how)
    bgr: Any = cv2.cvtColor(luminance, cv2.COLOR_YCrCb2BGR)
    return Pixels(bgr, pixels.valid)


def _equalized(plane: NDArray[np.uint8], how: str) -> Any:
    check_choice("equalize", how, EQUALIZATIONS)
    if how == "histogram":
        return cv2.equalizeHist(plane)
    return cv2.createCLAHE(_CLAHE_CLIP_LIMIT, _CLAHE_TILES).apply(plane)


def scale_matrix(before: tuple[int, int], after: tuple[int, int]) -> NDArray[np.float64]:
    """(3, 3) matrix from pixel coordinates before resizing to those after.

    Sizes are (width, height). The *areas* of the images coincide; with pixel centres at integers,
    x' = s (x + 0.5) - 0.5.
    """
    sx, sy = after[0] / before[0], after[1] / before[1]
    return np.array(
        [[sx, 0.0, 0.5 * sx - 0.5], [0.0, sy, 0.5 * sy - 0.5], [0.0, 0.0, 1.0]], dtype=np.float64
    )
