"""Metrics against ground truth."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.dataset import Pixels
from aerocues.datasets.true_geometry import Points
from aerocues.evaluation.correspondence import Correspondence, transfer

REPEATABILITY_RADIUS = 3.0


def _distinct(points: Points) -> NDArray[np.float64]:
    return np.asarray(np.unique(points, axis=0), np.float64)


def repeatability(points_1: Points, points_2: Points, truth: Correspondence) -> float | None:
    """Share of covisible keypoints found again, one to one (Mikolajczyk et al., IJCV 2005).

    Two keypoints correspond if each is the nearest to the other and they are at most 3 px apart in
    image 2. Keypoints at the same position (SIFT has one per orientation) count once. The share
    refers to the smaller of the two covisible sets.

    Returns
    -------
    float or None
        None if one image has no covisible keypoints.
    """
    # The import takes a tenth of a second in each worker, and most workers never need it.
    from scipy.spatial import cKDTree

    moved, second = truth.shared(_distinct(points_1), _distinct(points_2))
    if not len(moved) or not len(second):
        return None
    distance, forth = cKDTree(second).query(moved, distance_upper_bound=REPEATABILITY_RADIUS)
    back = cKDTree(moved).query(second, distance_upper_bound=REPEATABILITY_RADIUS)[1]
    found = np.flatnonzero(np.isfinite(distance))
    same = int((np.asarray(back)[np.asarray(forth)[found]] == found).sum())
    return same / min(len(moved), len(second))


def corner_error(
    estimate: NDArray[np.float64] | None, homography: NDArray[np.float64], pixels_1: Pixels
) -> float:
    """Mean distance in pixels between the four corners of image 1 under both homographies.

    Infinite if there is no estimate, or if it maps a corner to infinity.
    """
    if estimate is None:
        return float("inf")
    height, width = pixels_1.bgr.shape[:2]
    corners = np.array(
        [(0, 0), (width - 1, 0), (width - 1, height - 1), (0, height - 1)], np.float64
    )
    # The sign of a homography is arbitrary; the centre must be in front of the camera.
    centre = np.array([(width - 1) / 2, (height - 1) / 2, 1.0])
    oriented = estimate if estimate[2] @ centre > 0 else -estimate
    difference = transfer(corners, oriented) - transfer(corners, homography)
    return float(np.nan_to_num(np.linalg.norm(difference, axis=1), nan=np.inf).mean())


def area_under_curve(error: float, limit: float) -> float:
    """Area under the cumulative curve of one error up to `limit`, over `limit`: in [0, 1].

    The mean over pairs is the usual AUC of a set of errors.
    """
    return max(0.0, 1.0 - error / limit)
