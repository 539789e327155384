"""Projects points of one image into another, and tests their visibility, by pose and depth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.dataset import TrueView

SAME_SURFACE = 0.005
"""Relative difference of depth below which two points are on the same surface: a larger value
accepts occluded points, a smaller one rejects steep surfaces."""

Array = NDArray[np.float64]
Points = NDArray[np.float32] | NDArray[np.float64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Located:
    """An image's true view with its inverse depth.

    Parameters
    ----------
    view : TrueView
    inverse : (H, W) float64
        1 / depth in metres; 0 in the sky, NaN where unknown.
    """

    view: TrueView
    inverse: Array

    @classmethod
    def of(cls, view: TrueView) -> Located:
        """Read the depth of a view that has one; ImageError if that fails."""
        assert view.depth is not None
        with np.errstate(divide="ignore"):
            return cls(view, 1.0 / view.depth.read().astype(np.float64))


def inverse_depths(points: Points, inverse: Array) -> tuple[Array, Array]:
    """The nearer and the farther inverse depth of points; they are equal on a single surface.

    The inverse depth of a plane is linear in the image, so that it is interpolated between four
    pixels of one surface. On an edge between two surfaces, a point may belong to either.

    Parameters
    ----------
    points : (N, 2)
        Pixels, centres at integers.
    inverse : (H, W) float64

    Returns
    -------
    (N,), (N,) float64
    """
    height, width = inverse.shape
    column, row = np.asarray(points, np.float64).reshape(-1, 2).T
    left = np.clip(np.floor(column), 0, width - 2).astype(np.intp)
    top = np.clip(np.floor(row), 0, height - 2).astype(np.intp)
    u, v = np.clip(column - left, 0, 1), np.clip(row - top, 0, 1)
    corners = np.stack([inverse[top + i, left + j] for i in (0, 1) for j in (0, 1)])
    shares = np.stack([(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v])
    between = (corners * shares).sum(axis=0)
    near, far = corners.max(axis=0), corners.min(axis=0)
    single = near - far <= SAME_SURFACE * near
    return np.where(single, between, near), np.where(single, between, far)


def project(points: Points, inverse: Array, here: TrueView, there: TrueView) -> tuple[Array, Array]:
    """Project points of one view into another.

    Parameters
    ----------
    points : (N, 2)
    inverse : (N,) float64
        Inverse depths of the points.
    here, there : TrueView

    Returns
    -------
    (N, 2), (N,) float64
        Pixels and inverse depths in the other view; NaN behind the camera.
    """
    camera, other = here.camera, there.camera
    column, row = np.asarray(points, np.float64).reshape(-1, 2).T
    x, y = (column - camera.centre_x) / camera.focal_x, (row - camera.centre_y) / camera.focal_y
    rays = np.column_stack([x, y, np.ones(len(x))])
    # Divided by the depth, so that points at infinity can be projected, too.
    world = rays @ here.rotation + inverse[:, None] * (here.centre - there.centre)
    x, y, z = (world @ there.rotation.T).T
    z = np.where(z > 1e-12, z, np.nan)
    columns, rows = other.focal_x * x / z + other.centre_x, other.focal_y * y / z + other.centre_y
    return np.column_stack([columns, rows]), inverse / z


def find_seen(points: Points, here: Located, there: Located) -> tuple[Array, Mask]:
    """Project points into another view, and test whether they are visible there.

    Parameters
    ----------
    points : (N, 2)
    here, there : Located

    Returns
    -------
    (N, 2) float64, (N,) bool
        Pixels, NaN if not visible: outside the image, behind the camera or occluded.
    """
    moved = np.full((len(points), 2), np.nan)
    seen = np.zeros(len(points), np.bool_)
    for inverse in inverse_depths(points, here.inverse):
        at, expected = project(points, inverse, here.view, there.view)
        inside = nearest_pixels(at, there.inverse.shape)[1]
        shown = inside.copy()
        shown[inside] = _on_surface(at[inside], expected[inside], there.inverse)
        new = shown & ~seen
        moved[new], seen = at[new], seen | shown
    return moved, seen


def _on_surface(at: Array, expected: Array, inverse: Array) -> Mask:
    surfaces = inverse_depths(at, inverse)
    near = [
        np.abs(expected - each) <= SAME_SURFACE * np.maximum(expected, each) for each in surfaces
    ]
    return np.asarray(near[0] | near[1], np.bool_)


def nearest_pixels(points: Array, shape: tuple[int, ...]) -> tuple[NDArray[np.intp], Mask]:
    """Columns and rows (N, 2) of the nearest pixels, and whether they are inside the image.

    Parameters
    ----------
    points : (N, 2) float64
        NaN counts as outside.
    shape : tuple of int
        Height and width.
    """
    # Clipped, because distant points could overflow an integer; they are outside anyway.
    finite = np.clip(np.nan_to_num(points, nan=-9.0), -9.0, 1e9)
    rounded = np.floor(finite + 0.5).astype(np.intp)
    inside = (rounded >= 0).all(axis=1) & (rounded < (shape[1], shape[0])).all(axis=1)
    return rounded, np.asarray(inside, np.bool_)
