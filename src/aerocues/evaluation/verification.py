"""Robust two-view verification with MAGSAC++, and the chance test."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from aerocues.evaluation.clock import Clock, StageTime
from aerocues.evaluation.protocol import ChanceTest, MeasurementProtocol, Verification
from aerocues.methods.arrays import Float32Array

MINIMUM_FOR_HOMOGRAPHY = 4
IndexArray = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Model:
    """A model of two views: the (3, 3) float64 matrix, or None, and the (M,) bool inliers."""

    matrix: NDArray[np.float64] | None
    inliers: NDArray[np.bool_]

    @property
    def count(self) -> int:
        return int(self.inliers.sum())


def magsac_parameters(settings: Verification, *, guided: bool = False, seed: int = 0) -> Any:
    """OpenCV's USAC parameters that equal ``USAC_MAGSAC`` at the default settings.

    With `guided`, samples are drawn from the first matches first (PROSAC).
    """
    parameters = cv2.UsacParams()
    parameters.threshold = settings.threshold
    parameters.confidence = settings.confidence
    parameters.maxIterations = settings.max_iterations
    parameters.score = cv2.SCORE_METHOD_MAGSAC
    parameters.sampler = cv2.SAMPLING_PROSAC if guided else cv2.SAMPLING_UNIFORM
    parameters.loMethod = cv2.LOCAL_OPTIM_INNER_LO
    parameters.loIterations = 10
    parameters.loSampleSize = 50
    parameters.randomGeneratorState = seed
    parameters.isParallel = False
    return parameters


def _has_rank_two(matrix: Any) -> bool:
    """Whether any two rows of a (3, 3) matrix are independent: a 2 x 2 minor is not zero."""
    (a, b, c), (d, e, f), (g, h, i) = matrix.tolist()
    minors = (
        *(a * e - b * d, a * f - c * d, b * f - c * e),
        *(a * h - b * g, a * i - c * g, b * i - c * h),
        *(d * h - e * g, d * i - f * g, e * i - f * h),
    )
    largest = max(abs(value) for value in (a, b, c, d, e, f, g, h, i))
    return bool(max(abs(minor) for minor in minors) > 1e-12 * largest * largest)


def _checked(matrix: Any, mask: Any, count: int) -> Model:
    """The model if it is one: a single finite matrix of rank two or more, with inliers."""
    nothing = Model(None, np.zeros(count, bool))
    if matrix is None or mask is None or matrix.shape != (3, 3) or not np.isfinite(matrix).all():
        return nothing
    if not _has_rank_two(matrix):
        return nothing
    inliers = np.asarray(mask).reshape(-1).astype(bool)
    return Model(np.asarray(matrix, np.float64), inliers) if inliers.any() else nothing


def _estimate(
    find: Callable[..., Any], points_1: Float32Array, points_2: Float32Array, parameters: Any
) -> tuple[Any, Any]:
    """What OpenCV finds; where every sample is degenerate it raises instead of finding nothing."""
    try:
        matrix, mask = find(points_1, points_2, parameters)
    except cv2.error as error:
        if "!model.empty()" in str(error):
            return None, None
        raise
    return matrix, mask


def estimate_homography(points_1: Float32Array, points_2: Float32Array, parameters: Any) -> Model:
    """A homography from (M, 2) matched points; no matrix where there is none."""
    count = len(points_1)
    if count < MINIMUM_FOR_HOMOGRAPHY:
        return Model(None, np.zeros(count, bool))
    matrix, mask = _estimate(cv2.findHomography, points_1, points_2, parameters)
    return _checked(matrix, mask, count)


@dataclass(frozen=True, eq=False)
class Verdict:
    """The outcome of verifying one set of matches.

    Parameters
    ----------
    model : Model
        The fundamental matrix; its inliers are in the order of the matches that were given.
    sampling : {"uniform", "guided"}
        How the samples were drawn that gave the model.
    chance_mean, chance_max : float, int or None
        Inliers that shuffled matches give; None where that was not asked.
    passed : bool
        Whether there is a model and, where asked, it beats chance.
    time : StageTime
        Of the estimation alone, without the shuffled ones.
    """

    model: Model
    sampling: str
    chance_mean: float | None
    chance_max: int | None
    passed: bool
    time: StageTime


class Verifier:
    """Estimates fundamental matrices under a protocol."""

    def __init__(self, protocol: MeasurementProtocol, clock: Clock) -> None:
        self._protocol = protocol
        self._clock = clock
        self.uniform = magsac_parameters(protocol.verification, seed=protocol.seed)
        self.guided = magsac_parameters(protocol.verification, guided=True, seed=protocol.seed)

    def verify(self, points_1: Float32Array, points_2: Float32Array, order: IndexArray) -> Verdict:
        """Estimate and judge a fundamental matrix.

        Parameters
        ----------
        points_1, points_2 : (M, 2) float32
            Matched points in pixels, M at least the protocol's ``minimum_matches``.
        order : (M,) int
            The matches by descriptor distance, the smallest first.

        Raises
        ------
        cv2.error
            If OpenCV refuses the points.
        """
        chance = self._protocol.chance
        factor = None if chance is None else chance.factor
        first = self._look(points_1, points_2, self.uniform, factor, "uniform")
        if first.passed or chance is None:
            return first
        second = self._look(
            np.ascontiguousarray(points_1[order]),
            np.ascontiguousarray(points_2[order]),
            self.guided,
            chance.guided_factor,
            "guided",
        )
        time = first.time + second.time
        if not second.passed:
            return replace(first, time=time)
        inliers = np.zeros(len(order), bool)
        inliers[order] = second.model.inliers
        return replace(second, model=Model(second.model.matrix, inliers), time=time)

    def _look(
        self,
        points_1: Float32Array,
        points_2: Float32Array,
        parameters: Any,
        factor: float | None,
        sampling: str,
    ) -> Verdict:
        count = len(points_1)
        cv2.setRNGSeed(self._protocol.seed)
        raw, time = self._clock.time(
            lambda: _estimate(cv2.findFundamentalMat, points_1, points_2, parameters)
        )
        matrix, mask = raw
        model = _checked(matrix, mask, count)
        if factor is None:
            return Verdict(model, sampling, None, None, model.matrix is not None, time)
        shuffled = self._shuffled_counts(points_1, points_2, parameters)
        passed = model.matrix is not None and model.count > factor * max(shuffled)
        return Verdict(model, sampling, float(np.mean(shuffled)), max(shuffled), passed, time)

    def _shuffled_counts(
        self, points_1: Float32Array, points_2: Float32Array, parameters: Any
    ) -> list[int]:
        chance = self._protocol.chance or ChanceTest()
        counts = []
        for shuffle in range(chance.shuffles):
            generator = np.random.default_rng((self._protocol.seed, shuffle))
            shuffled = np.ascontiguousarray(points_2[generator.permutation(len(points_2))])
            matrix, mask = _estimate(cv2.findFundamentalMat, points_1, shuffled, parameters)
            counts.append(_checked(matrix, mask, len(points_1)).count)
        return counts
