"""By what candidates of a search are judged: CUES, or one criterion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from aerocues.scoring.criteria import Criterion, criteria_named
from aerocues.scoring.objectives import OBJECTIVES, Objective
from aerocues.scoring.settings import ScoreSettings, preset_named
from aerocues.tuning.scales import Array
from aerocues.tuning.valuation import Valuation

CUES = "cues"
GEOMETRY = Criterion(
    "geometry_auc",
    column='coalesce("homography_auc@3", "pose_auc@10", 0)',
    description="accuracy of the homography up to 3 px, or of the pose up to 10 degrees",
)
"""What inlier thresholds are judged by: more inliers are no merit of theirs."""


@dataclass(frozen=True)
class Yardstick:
    """Criteria and how they become one score.

    Parameters
    ----------
    criteria : tuple of Criterion
    objective : Objective or None
        None where there is one criterion, whose mean is the score.
    settings : ScoreSettings
    """

    criteria: tuple[Criterion, ...]
    objective: Objective | None = None
    settings: ScoreSettings = ScoreSettings()  # noqa: RUF009 - it is frozen

    def scores(self, training: Array) -> Array:
        """(A,) scores of candidates from (A, P, C) values, NaN where one failed."""
        return np.asarray(self._valued(training, training, None).mean(axis=1))

    def on_others(self, training: Array, values: Array) -> Array:
        """(B, P) scores of other values (B, P, C), weighed as in training."""
        weights = None
        if self.objective is not None:
            weights = self._valuation(self._filled(training), None).weights
        return self._valued(values, values, weights)

    def _valued(self, bounds: Array, values: Array, weights: Array | None) -> Array:
        filled = self._filled(values)
        if self.objective is None:
            sign = -1.0 if self.criteria[0].better == "lower" else 1.0
            return np.asarray(sign * filled[..., 0])
        value = self._valuation(self._filled(bounds), weights)
        return np.stack([value.of(filled[:, [pair]]) for pair in range(filled.shape[1])], axis=1)

    def _valuation(self, expected: Array, weights: Array | None) -> Valuation:
        assert self.objective is not None
        blocks = np.zeros(expected.shape[1], np.int64)
        return Valuation(expected, self.criteria, blocks, self.settings, self.objective, weights)

    def _filled(self, values: Array) -> Array:
        """With the worst value of each criterion where one failed; shares and counts fail at 0."""
        costs = np.array([criterion.better == "lower" for criterion in self.criteria])
        known = np.where(np.isnan(values), -np.inf, values)
        most = np.where(np.isfinite(known.max(axis=(0, 1))), known.max(axis=(0, 1)), 0.0)
        return np.where(np.isnan(values), np.where(costs, most, 0.0), values)


def yardstick(name: str) -> Yardstick:
    """CUES with the default preset of scoring, or a criterion by its name.

    Raises
    ------
    ScoreError
        If there is no such criterion.
    """
    if name.lower() == CUES:
        preset = preset_named("default")
        criteria = tuple(criteria_named(preset.criteria))
        return Yardstick(criteria, OBJECTIVES["balanced"], preset.settings)
    return Yardstick(tuple(criteria_named([name])))


def of_threshold() -> Yardstick:
    """What inlier thresholds are judged by."""
    return Yardstick((GEOMETRY,))


def mean_difference(first: Array, second: Array, seed: int) -> tuple[float, float, float]:
    """Mean of second - first over pairs, and a 95 % interval from 2,000 resamples of the pairs."""
    difference = second - first
    rng = np.random.default_rng(seed)
    drawn = rng.integers(len(difference), size=(2000, len(difference)))
    low, high = np.quantile(difference[drawn].mean(axis=1), [0.025, 0.975])
    return float(difference.mean()), float(low), float(high)
