"""Metrics against ground truth."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.dataset import Pixels
from aerocues.pipeline.correspondence import transfer


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
