"""What is right of the matches and keypoints of two images, by what relates the images."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.true_geometry import Points
from aerocues.methods.arrays import Float32Array
from aerocues.pipeline.correspondence import Correspondence
from aerocues.results.schema import PIXEL_THRESHOLDS

REPEATABILITY_RADIUS = 3.0
RIGHT = 3.0
"""Pixels within which a match is right where a single figure needs to know."""

CELLS = 16
"""Along each side of an image whose coverage is asked for."""


class PointFigures:
    """Figures of matches and keypoints under names with a prefix.

    Parameters
    ----------
    prefix : str
        ``gt`` for what is known to be true, ``ref`` for a reference.
    """

    def __init__(self, prefix: str) -> None:
        self._prefix = prefix
        self._repeatabilities: dict[tuple[bytes, bytes], float | None] = {}

    def begin_pair(self) -> None:
        """Forget what was remembered of the pair before."""
        self._repeatabilities.clear()

    def of(
        self,
        errors: NDArray[np.float64],
        keypoints: tuple[Float32Array, Float32Array],
        correspondence: Correspondence,
    ) -> dict[str, float | None]:
        """Precision, matching score and repeatability.

        Parameters
        ----------
        errors : (M,) float64
            Of the matches, pixels.
        keypoints : tuple of (N, 2) float32
            Positions of all keypoints of both images; a pair matcher may have found none.
        correspondence : Correspondence
            Between the two images; the same as long as no other pair begins.
        """
        figures: dict[str, float | None] = {}
        for threshold in PIXEL_THRESHOLDS:
            right = int((errors <= threshold).sum())
            if len(errors):
                figures[f"{self._prefix}_precision@{threshold}"] = right / len(errors)
            if len(keypoints[0]):
                figures[f"{self._prefix}_matching_score@{threshold}"] = right / len(keypoints[0])
        same = (keypoints[0].tobytes(), keypoints[1].tobytes())
        if same not in self._repeatabilities:
            self._repeatabilities[same] = repeatability(*keypoints, correspondence)
        figures[f"{self._prefix}_repeatability"] = self._repeatabilities[same]
        return figures


def coverage(right: Points, shape: tuple[int, ...]) -> float:
    """Share of the cells of a grid on an image that hold at least one of some points (N, 2).

    Parameters
    ----------
    right : (N, 2)
        Pixels, centres at integers.
    shape : tuple of int
        Height and width of the image.
    """
    height, width = shape[:2]
    cells = np.floor((np.asarray(right, np.float64) + 0.5) * CELLS / (width, height))
    columns, rows = np.clip(cells, 0, CELLS - 1).astype(np.intp).T
    return len(np.unique(rows * CELLS + columns)) / CELLS**2


def _distinct(points: Points) -> NDArray[np.float64]:
    return np.asarray(np.unique(points, axis=0), np.float64)


def repeatability(
    points_1: Points, points_2: Points, correspondence: Correspondence
) -> float | None:
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

    moved, second = correspondence.shared(_distinct(points_1), _distinct(points_2))
    if not len(moved) or not len(second):
        return None
    distance, forth = cKDTree(second).query(moved, distance_upper_bound=REPEATABILITY_RADIUS)
    back = cKDTree(moved).query(second, distance_upper_bound=REPEATABILITY_RADIUS)[1]
    found = np.flatnonzero(np.isfinite(distance))
    same = int((np.asarray(back)[np.asarray(forth)[found]] == found).sum())
    return same / min(len(moved), len(second))
