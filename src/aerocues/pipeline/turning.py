"""Images turned by quarters before features are found, and positions turned back: exact."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.dataset import Pixels
from aerocues.methods.arrays import Float32Array, Keypoints

Size = tuple[int, int]
"""Width and height in pixels."""


def turned_pixels(pixels: Pixels, turn: int) -> Pixels:
    """The image turned counterclockwise by `turn` degrees, a multiple of 90."""
    if turn % 360 == 0:
        return pixels
    quarters = turn // 90
    bgr = np.ascontiguousarray(np.rot90(pixels.bgr, quarters))
    valid = pixels.valid
    return Pixels(bgr, None if valid is None else np.ascontiguousarray(np.rot90(valid, quarters)))


def turned_size(size: Size, turn: int) -> Size:
    """The size of an image of `size` that was turned."""
    return size if turn % 180 == 0 else (size[1], size[0])


def turned_points(xy: NDArray[np.floating], size: Size, turn: int) -> Float32Array:
    """Where (N, 2) points of an image of `size` are once it is turned."""
    (width, height), (x, y) = size, np.asarray(xy, np.float32).T
    turned = {
        0: (x, y),
        90: (y, width - 1 - x),
        180: (width - 1 - x, height - 1 - y),
        270: (height - 1 - y, x),
    }[turn % 360]
    return np.ascontiguousarray(np.stack(turned, axis=1), np.float32)


def turned_keypoints(keypoints: Keypoints, size: Size, turn: int) -> Keypoints:
    """Keypoints of an image of `size` in the turned image, with their orientations."""
    if turn % 360 == 0:
        return keypoints
    angle = np.where(keypoints.angle < 0, keypoints.angle, (keypoints.angle - turn) % 360)
    xy = turned_points(keypoints.xy, size, turn)
    return replace(keypoints, xy=xy, angle=angle.astype(np.float32))
