"""Photometric transformations of an image: intensity, contrast, noise, blur, JPEG."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

Bgr = NDArray[np.uint8]
Change = Callable[[Bgr, float, bool], Bgr]
"""Returns the changed image, from an image, a value, and whether its channels are equal."""

_MIDDLE_GRAY = 128.0
_NOISE_SEED = 7


def _clipped(values: NDArray[np.float32]) -> Bgr:
    return np.rint(np.clip(values, 0, 255)).astype(np.uint8)


def _added(bgr: Bgr, levels: float, gray: bool) -> Bgr:
    return _clipped(bgr.astype(np.float32) + np.float32(levels))


def _multiplied(bgr: Bgr, factor: float, gray: bool) -> Bgr:
    return _clipped(bgr.astype(np.float32) * np.float32(factor))


def _contrasted(bgr: Bgr, factor: float, gray: bool) -> Bgr:
    middle = np.float32(_MIDDLE_GRAY)
    return _clipped((bgr.astype(np.float32) - middle) * np.float32(factor) + middle)


def _noisy(bgr: Bgr, sigma: float, gray: bool) -> Bgr:
    """Gaussian noise; the same for all channels of a gray image, else independent per channel."""
    shape = (*bgr.shape[:2], 1 if gray else 3)
    noise = np.random.default_rng(_NOISE_SEED).standard_normal(shape, dtype=np.float32)
    return _clipped(bgr.astype(np.float32) + np.float32(sigma) * noise)


def _blurred(bgr: Bgr, sigma: float, gray: bool) -> Bgr:
    blurred: Any = cv2.GaussianBlur(bgr, (0, 0), sigma)
    return np.asarray(blurred, dtype=np.uint8)


def _compressed(bgr: Bgr, quality: float, gray: bool) -> Bgr:
    _, file = cv2.imencode(".jpg", bgr, [cv2.IMWRITE_JPEG_QUALITY, int(quality)])
    decoded: Any = cv2.imdecode(file, cv2.IMREAD_COLOR)
    return np.asarray(decoded, dtype=np.uint8)


CHANGES: dict[str, Change] = {
    "intensity_add": _added,
    "intensity_mul": _multiplied,
    "contrast": _contrasted,
    "noise": _noisy,
    "blur": _blurred,
    "jpeg": _compressed,
}
"""Kinds of transformation; values: gray levels, factor, factor about middle gray, sigma in gray
levels, sigma in pixels, quality from 0 to 100."""
