"""Robust two-view verification with MAGSAC++, and the chance test."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from aerocues.evaluation.protocol import ChanceTest, Verification

MINIMUM_FOR_HOMOGRAPHY = 4


@dataclass(frozen=True, eq=False)
class Model:
    """A model of two views: the (3, 3) float64 matrix, or None, and the (M,) bool inliers."""

    matrix: NDArray[np.float64] | None
    inliers: NDArray[np.bool_]

    @property
    def count(self) -> int:
        return int(self.inliers.sum())


def magsac_parameters(settings: Verification) -> Any:
    """OpenCV's USAC parameters that equal ``USAC_MAGSAC`` at the default settings."""
    parameters = cv2.UsacParams()
    parameters.threshold = settings.threshold
    parameters.confidence = settings.confidence
    parameters.maxIterations = settings.max_iterations
    parameters.score = cv2.SCORE_METHOD_MAGSAC
    parameters.sampler = cv2.SAMPLING_UNIFORM
    parameters.loMethod = cv2.LOCAL_OPTIM_INNER_LO
    parameters.loIterations = 10
    parameters.loSampleSize = 50
    parameters.randomGeneratorState = 0
    parameters.isParallel = False
    return parameters


def _checked(matrix: Any, mask: Any, count: int) -> Model:
    """The model if it is one: a single finite matrix of rank two or more, with inliers."""
    nothing = Model(None, np.zeros(count, bool))
    if matrix is None or mask is None or matrix.shape != (3, 3) or not np.isfinite(matrix).all():
        return nothing
    strength = np.linalg.svd(matrix, compute_uv=False)
    if strength[1] <= 1e-12 * strength[0]:
        return nothing
    inliers = np.asarray(mask).reshape(-1).astype(bool)
    return Model(np.asarray(matrix, np.float64), inliers) if inliers.any() else nothing


def find_fundamental(points_1: Any, points_2: Any, parameters: Any) -> tuple[Any, Any]:
    """The bare call, for the clock."""
    return cv2.findFundamentalMat(points_1, points_2, parameters)  # type: ignore[no-any-return]


def read_model(raw: tuple[Any, Any], count: int) -> Model:
    """The checked model that a bare call over `count` matches returned."""
    return _checked(*raw, count)


def estimate_homography(
    points_1: NDArray[np.float32], points_2: NDArray[np.float32], settings: Verification
) -> Model:
    """A homography from (M, 2) matched points; no matrix where there is none."""
    count = len(points_1)
    if count < MINIMUM_FOR_HOMOGRAPHY:
        return Model(None, np.zeros(count, bool))
    matrix, mask = cv2.findHomography(points_1, points_2, magsac_parameters(settings))
    return _checked(matrix, mask, count)


def chance_inliers(
    points_1: NDArray[np.float32],
    points_2: NDArray[np.float32],
    settings: Verification,
    test: ChanceTest,
    seed: int,
) -> tuple[float, int]:
    """Mean and largest number of inliers that shuffled matches give.

    Parameters
    ----------
    points_1, points_2 : (M, 2) float32
        Matched points in pixels, M at least ``settings.minimum_matches``.
    """
    parameters = magsac_parameters(settings)
    counts = []
    for shuffle in range(test.shuffles):
        order = np.random.default_rng((seed, shuffle)).permutation(len(points_2))
        raw = find_fundamental(points_1, np.ascontiguousarray(points_2[order]), parameters)
        counts.append(read_model(raw, len(points_1)).count)
    return float(np.mean(counts)), max(counts)
