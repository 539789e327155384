"""Images in the sizes that the networks take."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

Float32Array = NDArray[np.float32]
CELL = 32
"""Widths and heights are multiples of it: the networks halve their maps five times."""


def fitted_size(image: NDArray[np.uint8], longest_side: int) -> tuple[int, int]:
    """Width and height of an image whose longest side is not above a limit; 0 is no limit."""
    height, width = image.shape[:2]
    factor = min(1.0, longest_side / max(width, height)) if longest_side else 1.0
    return max(round(width * factor), 1), max(round(height * factor), 1)


def resized(image: NDArray[Any], size: tuple[int, int]) -> NDArray[Any]:
    """An image in another size; pixels are averaged where it becomes smaller by more than a row."""
    height, width = image.shape[:2]
    if size == (width, height):
        return image
    shrinks = min(width - size[0], height - size[1]) >= CELL
    interpolation = cv2.INTER_AREA if shrinks else cv2.INTER_LINEAR
    return np.asarray(cv2.resize(image, size, interpolation=interpolation))


def in_original_pixels(
    xy: Float32Array, size: tuple[int, int], image: NDArray[np.uint8]
) -> Float32Array:
    """Points of an image of `size` (width, height) in pixels of the image that it was made of.

    The centre of the top-left pixel is (0, 0) in both, so that half pixels count.
    """
    height, width = image.shape[:2]
    factors = np.array([width / size[0], height / size[1]], np.float32)
    return np.asarray((xy + 0.5) * factors - 0.5, np.float32)


def padded_to_cells(image: NDArray[Any]) -> tuple[NDArray[Any], tuple[int, int]]:
    """An image with its border repeated up to multiples of `CELL`, and where it begins: left, top.

    The rows and columns go to both sides alike, as ALIKED was trained.
    """
    height, width = image.shape[:2]
    below, right = -height % CELL, -width % CELL
    top, left = below // 2, right // 2
    padded = cv2.copyMakeBorder(image, top, below - top, left, right - left, cv2.BORDER_REPLICATE)
    return np.asarray(padded), (left, top)
