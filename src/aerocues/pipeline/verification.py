"""Robust two-view verification with MAGSAC++, and the chance test."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.dataset import Geometry
from aerocues.methods.arrays import Float32Array
from aerocues.pipeline.clock import Clock, StageTime
from aerocues.pipeline.protocol import MeasurementProtocol, Verification

MINIMUM_FOR_HOMOGRAPHY = 4
POSE_THRESHOLD = 1.0
"""Inlier threshold in pixels where a pose is estimated. With 3 px a flat scene seen from above fits
two poses alike: on pairs 40 m apart at 140 m every third estimate was 80 degrees or more off."""

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


def estimate_fundamental_matrix(
    points_1: Float32Array, points_2: Float32Array, parameters: Any
) -> Model:
    """A fundamental matrix from (M, 2) matched points, M at least 8; no matrix if there is none."""
    raw = _estimate(cv2.findFundamentalMat, points_1, points_2, parameters)
    return _checked(*raw, len(points_1))


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
        The model; its inliers are in the order of the matches that were given.
    sampling : {"uniform", "guided", "homography"}
        How it was found: a fundamental matrix from uniform or from guided samples, or a homography
        from guided ones.
    chance_mean, chance_max : float, int or None
        Inliers that shuffled matches give; None where the verifier does not count them all.
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

    @classmethod
    def too_few(cls, matches: int) -> Verdict:
        """The outcome where there are too few matches to look for a model."""
        nothing = Model(None, np.zeros(matches, bool))
        return cls(nothing, "uniform", None, None, passed=False, time=StageTime(0.0, 0.0))

    @property
    def status(self) -> str:
        """``ok``, ``chance`` or ``no_model``."""
        if self.model.matrix is None:
            return "no_model"
        return "ok" if self.passed else "chance"


@dataclass(frozen=True, eq=False)
class Attempt:
    """One RANSAC estimate, and by what factor it must beat how many shuffled sets.

    Without shuffles there is no test against chance.
    """

    sampling: str
    find: Callable[..., Any]
    parameters: Any
    factor: float = 0.0
    shuffles: int = 0


def attempts(protocol: MeasurementProtocol, geometry: Geometry) -> tuple[Attempt, ...]:
    """The attempts in order; the next one is made where one does not beat chance."""
    settings, seed, chance = protocol.verification, protocol.seed, protocol.chance
    uniform = magsac_parameters(settings, seed=seed)
    if chance is None:
        return (Attempt("uniform", cv2.findFundamentalMat, uniform),)
    guided = magsac_parameters(settings, guided=True, seed=seed)
    found = (
        Attempt("uniform", cv2.findFundamentalMat, uniform, chance.factor, chance.shuffles),
        Attempt("guided", cv2.findFundamentalMat, guided, chance.guided_factor, chance.shuffles),
    )
    if geometry != "homography":
        return found
    longer = replace(settings, max_iterations=chance.homography_iterations)
    last = magsac_parameters(longer, guided=True, seed=seed)
    factor = chance.homography_factor
    return (*found, Attempt("homography", cv2.findHomography, last, factor, chance.shuffles))


class Verifier:
    """Estimates and judges models of two views under a protocol.

    Parameters
    ----------
    protocol : MeasurementProtocol
    geometry : {"homography", "epipolar"}
        Of the dataset.
    clock : Clock
    count_all : bool
        Whether all shuffled sets are verified, for their mean. Otherwise none after the first one
        that a model does not beat: the verdict is the same, in about a third of the time where
        matches agree by chance.
    """

    def __init__(
        self,
        protocol: MeasurementProtocol,
        geometry: Geometry,
        clock: Clock,
        *,
        count_all: bool = True,
    ) -> None:
        self._protocol = protocol
        self._clock = clock
        self._attempts = attempts(protocol, geometry)
        self._count_all = count_all

    def verify(self, points_1: Float32Array, points_2: Float32Array, order: IndexArray) -> Verdict:
        """Estimate and judge a model.

        Parameters
        ----------
        points_1, points_2 : (M, 2) float32
            Matched points in pixels, M at least the protocol's ``minimum_matches``.
        order : (M,) int
            The matches by descriptor distance, the smallest first.

        Returns
        -------
        Verdict
            Of the first attempt that beats chance, else of the very first; with the time of all.

        Raises
        ------
        cv2.error
            If OpenCV refuses the points.
        """
        verdicts: list[Verdict] = []
        for attempt in self._attempts:
            verdicts.append(self._run(attempt, points_1, points_2, order))
            if verdicts[-1].passed:
                break
        chosen = verdicts[-1] if verdicts[-1].passed else verdicts[0]
        time = verdicts[0].time
        for verdict in verdicts[1:]:
            time += verdict.time
        return replace(chosen, time=time)

    def homography(
        self, points_1: Float32Array, points_2: Float32Array, order: IndexArray, sampling: str
    ) -> Model:
        """A homography, with the sampling that found the model of the same matches."""
        if sampling != "uniform":
            last = self._attempts[-1]
            return self._run(replace(last, shuffles=0), points_1, points_2, order).model
        return estimate_homography(points_1, points_2, self._attempts[0].parameters)

    def pose_parameters(self, sampling: str) -> tuple[Any, bool]:
        """OpenCV's parameters for a pose, and whether they want the best matches first."""
        protocol, guided = self._protocol, sampling != "uniform"
        closer = replace(protocol.verification, threshold=POSE_THRESHOLD)
        return magsac_parameters(closer, guided=guided, seed=protocol.seed), guided

    def _run(
        self, attempt: Attempt, points_1: Float32Array, points_2: Float32Array, order: IndexArray
    ) -> Verdict:
        count = len(points_1)
        if attempt.sampling != "uniform":
            points_1, points_2 = points_1[order], points_2[order]
        raw, time = self._clock.time(
            lambda: _estimate(attempt.find, points_1, points_2, attempt.parameters)
        )
        model = _checked(*raw, count)
        counts: list[int] = []
        for number in range(attempt.shuffles):
            counts.append(self._shuffled_count(attempt, points_1, points_2, number))
            if not self._count_all and model.count <= attempt.factor * counts[-1]:
                break
        passed = model.matrix is not None and model.count > attempt.factor * max(counts, default=0)
        if attempt.sampling != "uniform":
            inliers = np.zeros(count, bool)
            inliers[order] = model.inliers
            model = Model(model.matrix, inliers)
        told = counts and self._count_all
        mean, largest = (float(np.mean(counts)), max(counts)) if told else (None, None)
        return Verdict(model, attempt.sampling, mean, largest, passed, time)

    def _shuffled_count(
        self, attempt: Attempt, points_1: Float32Array, points_2: Float32Array, number: int
    ) -> int:
        generator = np.random.default_rng((self._protocol.seed, number))
        shuffled = points_2[generator.permutation(len(points_2))]
        raw = _estimate(attempt.find, points_1, shuffled, attempt.parameters)
        return _checked(*raw, len(points_1)).count
