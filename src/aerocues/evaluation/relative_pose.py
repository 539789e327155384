"""The pose of one camera relative to another: estimated from matches, and its error."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.dataset import PinholeCamera, TrueView
from aerocues.methods.arrays import Float32Array

MINIMUM_FOR_POSE = 5
_SAME_PLACE = 1e-9


@dataclass(frozen=True, eq=False)
class RelativePose:
    """The pose of camera 2 relative to camera 1.

    Parameters
    ----------
    rotation : (3, 3) float64
        Rotation from the axes of camera 1 to those of camera 2.
    direction : (3,) float64
        Direction of the translation in the axes of camera 2; its length is arbitrary.
    """

    rotation: NDArray[np.float64]
    direction: NDArray[np.float64]


def true_pose(first: TrueView, second: TrueView) -> RelativePose:
    """The relative pose of two true views."""
    return RelativePose(
        second.rotation @ first.rotation.T, second.rotation @ (first.centre - second.centre)
    )


def _matrix(camera: PinholeCamera) -> NDArray[np.float64]:
    return np.array(
        [
            [camera.focal_x, 0.0, camera.centre_x],
            [0.0, camera.focal_y, camera.centre_y],
            [0.0, 0.0, 1.0],
        ]
    )


def estimate_pose(
    points_1: Float32Array,
    points_2: Float32Array,
    cameras: tuple[PinholeCamera, PinholeCamera],
    parameters: Any,
) -> RelativePose | None:
    """The pose from the essential matrix of (M, 2) matched points; None if there is no solution.

    Nister, "An efficient solution to the five-point relative pose problem", PAMI 2004, inside
    MAGSAC++. Of the four poses of a matrix, the one with most points in front of both cameras.

    Raises
    ------
    cv2.error
        If OpenCV refuses the points.
    """
    if len(points_1) < MINIMUM_FOR_POSE:
        return None
    first, second = (_matrix(camera) for camera in cameras)
    try:
        essential, mask = cv2.findEssentialMat(
            points_1, points_2, first, second, None, None, parameters
        )
    except cv2.error as error:
        if "!model.empty()" in str(error):  # all samples were degenerate
            return None
        raise
    if essential is None or essential.shape != (3, 3) or not np.isfinite(essential).all():
        return None
    chosen = np.asarray(mask).reshape(-1).astype(bool)
    if not chosen.any():
        return None
    # Normalised coordinates of each camera, because one call supports only one camera.
    rays_1, rays_2 = (
        np.ascontiguousarray(cv2.undistortPoints(points[chosen][:, None], matrix, None)[:, 0])
        for points, matrix in ((points_1, first), (points_2, second))
    )
    _, rotation, direction, _ = cv2.recoverPose(essential, rays_1, rays_2, np.eye(3))
    return RelativePose(np.asarray(rotation, np.float64), np.asarray(direction, np.float64).ravel())


def pose_error(estimate: RelativePose | None, truth: RelativePose) -> float:
    """The larger of the two angles, in degrees, between rotations and between directions.

    Infinite without an estimate. Cameras at the same position have no direction; then only the
    rotation counts.
    """
    if estimate is None:
        return float("inf")
    turn = estimate.rotation @ truth.rotation.T
    rotation = _degrees(float(np.trace(turn) - 1) / 2)
    length = np.linalg.norm(truth.direction) * np.linalg.norm(estimate.direction)
    if length <= _SAME_PLACE:
        return rotation
    return max(rotation, _degrees(float(estimate.direction @ truth.direction / length)))


def _degrees(cosine: float) -> float:
    return float(np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))))
