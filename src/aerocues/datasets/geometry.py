"""Geometric transformations of an image with exact homographies: rotation, scale, tilt."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.dataset import Pixels
from aerocues.datasets.fitting import resize, scale_matrix

Matrix = NDArray[np.float64]
Size = tuple[int, int]

_FOCAL_LENGTH = 1.2
"""Focal length of the camera of tilted images, in units of the image's longer side."""


@dataclass(frozen=True)
class Warp:
    """A kind of geometric transformation.

    Parameters
    ----------
    place : callable
        Returns the (3, 3) matrix from old to new pixel coordinates (pixel centres at integers) and
        the new size (width, height), from the value and the old size.
    oversampling : int
        The image is warped at this multiple of its size and averaged down, against aliasing of
        shrunk parts; 1: only bilinear interpolation.
    """

    place: Callable[[float, Size], tuple[Matrix, Size]]
    oversampling: int = 1


def _rotated(degrees: float, size: Size) -> tuple[Matrix, Size]:
    """Counter-clockwise about the centre, on a canvas that contains the whole image."""
    # Rounded, so that a quarter turn hits the pixel grid exactly (0 and not 6e-17).
    cos = round(math.cos(math.radians(degrees)), 15)
    sin = round(math.sin(math.radians(degrees)), 15)
    width, height = size
    new_width = math.ceil(width * abs(cos) + height * abs(sin) - 1e-9)
    new_height = math.ceil(width * abs(sin) + height * abs(cos) - 1e-9)
    turn = np.array([[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]])
    back = _shift(-(width - 1) / 2, -(height - 1) / 2)
    return _shift((new_width - 1) / 2, (new_height - 1) / 2) @ turn @ back, (new_width, new_height)


def _scaled(factor: float, size: Size) -> tuple[Matrix, Size]:
    """To the nearest integer size; the matrix has the resulting factor of each axis."""
    new_size = max(1, round(size[0] * factor)), max(1, round(size[1] * factor))
    return scale_matrix(size, new_size), new_size


def _tilted(degrees: float, size: Size) -> tuple[Matrix, Size]:
    """The image as a plane that a camera sees rotated about its horizontal middle line."""
    width, height = size
    cos, sin = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    focal = _FOCAL_LENGTH * max(size)
    # (x, y, 0) turns to (x, y cos, -y sin); the camera looks from the distance `focal`.
    view = np.array([[focal, 0.0, 0.0], [0.0, focal * cos, 0.0], [0.0, -sin, focal]])
    view = view @ _shift(-(width - 1) / 2, -(height - 1) / 2)
    edges = np.array([[x, y, 1.0] for x in (-0.5, width - 0.5) for y in (-0.5, height - 0.5)])
    seen = edges @ view.T
    seen = seen[:, :2] / seen[:, 2:]
    low, high = seen.min(axis=0), seen.max(axis=0)
    new_size = math.ceil(high[0] - low[0]), math.ceil(high[1] - low[1])
    matrix = _shift(-float(low[0]) - 0.5, -float(low[1]) - 0.5) @ view
    return matrix / matrix[2, 2], new_size


def _shift(x: float, y: float) -> Matrix:
    return np.array([[1.0, 0.0, x], [0.0, 1.0, y], [0.0, 0.0, 1.0]])


WARPS = {
    "rotation": Warp(_rotated),
    "scale": Warp(_scaled),
    "tilt": Warp(_tilted, oversampling=3),
}
"""Kinds of geometric transformation; their values are degrees, a factor, degrees."""


def placement(kind: str, value: float, size: Size) -> tuple[Matrix, Size]:
    """The homography of a transformation, and the size (width, height) of its result.

    Parameters
    ----------
    kind : str
        A key of `WARPS`.
    value : float
        Degrees for ``rotation`` (counter-clockwise) and ``tilt``, a factor for ``scale``.
    size : (int, int)
        Width and height before.
    """
    return WARPS[kind].place(value, size)


def warp(pixels: Pixels, kind: str, value: float) -> Pixels:
    """Apply a transformation; pixels outside the original are black and not valid."""
    height, width = pixels.bgr.shape[:2]
    matrix, size = placement(kind, value, (width, height))
    if kind == "scale":  # resizing averages over areas if it shrinks, and has no border
        return resize(pixels, size)
    mask = np.ones((height, width), np.bool_) if pixels.valid is None else pixels.valid
    bgr = _warped(pixels.bgr, matrix, size, WARPS[kind].oversampling)
    covered = _warped(mask.astype(np.uint8) * 255, matrix, size, WARPS[kind].oversampling)
    valid = covered == 255
    return Pixels(bgr) if valid.all() else Pixels(bgr, valid)


def _warped(picture: NDArray[np.uint8], matrix: Matrix, size: Size, oversampling: int) -> Any:
    larger = (size[0] * oversampling, size[1] * oversampling)
    finer = scale_matrix(size, larger) @ matrix
    warped = cv2.warpPerspective(picture, finer, larger, flags=cv2.INTER_LINEAR)
    return warped if oversampling == 1 else cv2.resize(warped, size, interpolation=cv2.INTER_AREA)
