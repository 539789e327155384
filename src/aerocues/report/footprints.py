"""What images show of the ground: exact by poses and depth, else as if the ground were flat."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.dataset import Image, TrueView
from aerocues.datasets.decoding import FileSource
from aerocues.datasets.flight_angles import ENU_FROM_NED, camera_from_ned
from aerocues.datasets.gimbal import gimbal_view
from aerocues.errors import ImageError
from aerocues.reconstruction.focal_lengths import exif_focal_length

Array = NDArray[np.float64]
LEAST_DOWN = 0.2
"""Sine of the angle below the horizon: what is seen at less is far away, and not shown."""


def footprint(image: Image, place: Sequence[float]) -> Array | None:
    """The corners of an image on the ground, from the top left one clockwise.

    Parameters
    ----------
    image : Image
    place : (2,) sequence of float
        Where it was taken, metres to the east and north.

    Returns
    -------
    (4, 2) float64 or None
        Metres to the east and north; None where the pose, the height or the focal length is not
        known, the horizon is in view, or the file cannot be read.
    """
    try:
        if image.truth is not None:
            return _by_depth(image.truth)
        if isinstance(image.source, FileSource):
            return _on_flat_ground(image.source, place)
    except (ImageError, OSError):  # its pairs failed, too: the table says so
        return None
    return None


def _by_depth(view: TrueView) -> Array | None:
    if view.depth is None:
        return None
    camera = view.camera
    depth = view.depth.read()
    corners = _corners(camera.width, camera.height)
    columns, rows = np.clip(corners.round().astype(int), 0, depth.shape[1::-1] - np.array(1)).T
    rays = _rays(corners - (camera.centre_x, camera.centre_y), camera.focal_x, camera.focal_y)
    ground = (rays @ view.rotation) * depth[rows, columns, None] + view.centre
    return ground[:, :2] if np.isfinite(ground).all() else None


def _on_flat_ground(source: FileSource, place: Sequence[float]) -> Array | None:
    view = gimbal_view(source.header().xmp)
    if view is None:
        return None
    width, height = source.size()
    focal = exif_focal_length(source, max(width, height))
    if focal is None:
        return None
    middle = np.array([width - 1, height - 1]) / 2
    rotation = camera_from_ned(view.pitch, view.yaw, view.roll) @ ENU_FROM_NED.T
    rays = _rays(_corners(width, height) - middle, focal, focal) @ rotation
    down = -rays[:, 2]
    if (down < LEAST_DOWN * np.linalg.norm(rays, axis=1)).any():
        return None
    ground: Array = np.asarray(place) + rays[:, :2] * (view.height / down)[:, None]
    return ground


def _corners(width: int, height: int) -> Array:
    """Outer corners of the corner pixels."""
    right, bottom = width - 0.5, height - 0.5
    return np.array([[-0.5, -0.5], [right, -0.5], [right, bottom], [-0.5, bottom]])


def _rays(offsets: Array, focal_x: float, focal_y: float) -> Array:
    """Directions from the camera, 1 along its axis."""
    return np.column_stack([offsets / (focal_x, focal_y), np.ones(len(offsets))])
