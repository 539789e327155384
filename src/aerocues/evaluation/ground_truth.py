"""Metrics against a true homography."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from aerocues.datasets.dataset import Pixels

REPEATABILITY_RADIUS = 3.0

Points = NDArray[np.float32] | NDArray[np.float64]


def transfer(points: Points, homography: NDArray[np.float64]) -> NDArray[np.float64]:
    """Map (N, 2) points; those that pass through infinity become NaN."""
    homogeneous = np.column_stack([points, np.ones(len(points))]).astype(np.float64) @ homography.T
    depth = homogeneous[:, 2:]
    ahead = depth > 1e-12
    moved: NDArray[np.float64] = np.where(
        ahead, homogeneous[:, :2] / np.where(ahead, depth, 1), np.nan
    )
    return moved


def _inverse(homography: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(np.linalg.inv(homography), np.float64)


def transfer_errors(
    points_1: Points, points_2: Points, homography: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Distance in pixels of image 2 between each point and where the truth puts it.

    Returns
    -------
    (N,) float64
        Infinite where the true position lies behind the camera.
    """
    distance = np.linalg.norm(transfer(points_1, homography) - points_2, axis=1)
    errors: NDArray[np.float64] = np.nan_to_num(distance, nan=np.inf)
    return errors


def covisible(points: Points, homography: NDArray[np.float64], target: Pixels) -> NDArray[np.bool_]:
    """Which of (N, 2) points fall on valid pixels of the other image."""
    moved = transfer(points, homography)
    height, width = target.bgr.shape[:2]
    rounded = np.floor(np.nan_to_num(moved, nan=-9.0) + 0.5)
    inside: NDArray[np.bool_] = (
        (rounded[:, 0] >= 0)
        & (rounded[:, 1] >= 0)
        & (rounded[:, 0] < width)
        & (rounded[:, 1] < height)
    )
    if target.valid is not None:
        where = rounded[inside].astype(np.int64)
        inside[inside] = target.valid[where[:, 1], where[:, 0]]
    return inside


def _distinct(points: Points) -> NDArray[np.float64]:
    return np.asarray(np.unique(points, axis=0), np.float64)


def repeatability(
    points_1: Points,
    points_2: Points,
    homography: NDArray[np.float64],
    pixels_1: Pixels,
    pixels_2: Pixels,
) -> float | None:
    """Share of covisible keypoints found again, one to one (Mikolajczyk et al., IJCV 2005).

    Two keypoints are the same where each is the other's nearest and they lie at most 3 px apart
    in image 2. Keypoints at one position (SIFT has one for each orientation) count once. The share
    is of the smaller of the two covisible sets.

    Returns
    -------
    float or None
        None where one image has no covisible keypoint.
    """
    first, second = _distinct(points_1), _distinct(points_2)
    first = first[covisible(first, homography, pixels_2)]
    second = second[covisible(second, _inverse(homography), pixels_1)]
    if not len(first) or not len(second):
        return None
    moved = transfer(first, homography)
    distance, forth = cKDTree(second).query(moved, distance_upper_bound=REPEATABILITY_RADIUS)
    back = cKDTree(moved).query(second, distance_upper_bound=REPEATABILITY_RADIUS)[1]
    found = np.flatnonzero(np.isfinite(distance))
    same = int((np.asarray(back)[np.asarray(forth)[found]] == found).sum())
    return same / min(len(first), len(second))


def corner_error(
    estimate: NDArray[np.float64] | None, homography: NDArray[np.float64], pixels_1: Pixels
) -> float:
    """Mean distance in pixels between the four corners of image 1 under both homographies.

    Infinite where there is no estimate or it sends a corner through infinity.
    """
    if estimate is None:
        return float("inf")
    height, width = pixels_1.bgr.shape[:2]
    corners = np.array(
        [(0, 0), (width - 1, 0), (width - 1, height - 1), (0, height - 1)], np.float64
    )
    # A homography is known up to sign; the centre must stay in front of the camera.
    centre = np.array([(width - 1) / 2, (height - 1) / 2, 1.0])
    oriented = estimate if estimate[2] @ centre > 0 else -estimate
    difference = transfer(corners, oriented) - transfer(corners, homography)
    return float(np.nan_to_num(np.linalg.norm(difference, axis=1), nan=np.inf).mean())


def area_under_curve(error: float, limit: float) -> float:
    """Area under the cumulative curve of one error up to `limit`, over `limit`: in [0, 1].

    The mean over pairs is the usual AUC of a set of errors.
    """
    return max(0.0, 1.0 - error / limit)
