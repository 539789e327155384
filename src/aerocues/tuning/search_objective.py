"""The objective of a search: CUES, or one criterion."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass

import numpy as np

from aerocues.errors import ScoreError
from aerocues.scoring.criteria import Criterion, criteria_named
from aerocues.scoring.objectives import OBJECTIVES, Objective
from aerocues.scoring.settings import ScoreSettings, score_preset_named
from aerocues.scoring.valuation import Valuation
from aerocues.tuning.scales import Array

CUES = "cues"
FEWEST_SCENES = 3
"""Scenes whose means give an interval: with two, Student's t makes it uselessly wide."""
LEAST_GAIN = 0.005
"""Smallest gain to keep, in CUES or relative to the default's criterion: smaller gains are not
worth deviating from the default."""
GEOMETRY = Criterion(
    "geometry_auc",
    column='coalesce("homography_auc@3", "pose_auc@10", 0)',
    description="accuracy of the homography up to 3 px, or of the pose up to 10 degrees",
)
"""The objective of inlier thresholds: larger thresholds give more inliers, but not better ones."""


@dataclass(frozen=True)
class SearchObjective:
    """Criteria, and how they are combined into a score.

    Parameters
    ----------
    criteria : tuple of Criterion
    objective : Objective or None
        None for a single criterion: its mean is the score.
    settings : ScoreSettings
    """

    criteria: tuple[Criterion, ...]
    objective: Objective | None = None
    settings: ScoreSettings = ScoreSettings()  # noqa: RUF009 - it is frozen

    @property
    def reference(self) -> bool:
        """Whether only pairs with a reference tell candidates apart."""
        return any(criterion.reference for criterion in self.criteria)

    def scores(self, training: Array) -> Array:
        """(A,) scores of candidates from (A, P, C) values; NaN where one failed."""
        return np.asarray(self._valued(training, training, None).mean(axis=1))

    def on_others(self, training: Array, values: Array) -> Array:
        """(B, P) scores of other values (B, P, C), with the weights from training."""
        weights = None
        if self.objective is not None:
            weights = self._valuation(self._filled(training), None).weights
        return self._valued(values, values, weights)

    def least_gain(self, default: Array) -> float:
        """The smallest gain over these scores of the default that is worth keeping."""
        scale = 1.0 if self.objective is not None else abs(float(default.mean()))
        return LEAST_GAIN * scale

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
        """Failures replaced by the worst value of each criterion; 0 for shares and counts."""
        costs = np.array([criterion.better == "lower" for criterion in self.criteria])
        known = np.where(np.isnan(values), -np.inf, values)
        most = np.where(np.isfinite(known.max(axis=(0, 1))), known.max(axis=(0, 1)), 0.0)
        return np.where(np.isnan(values), np.where(costs, most, 0.0), values)


def search_objective(name: str) -> SearchObjective:
    """CUES with the default preset of scoring, without its links, or a criterion by its name.

    Raises
    ------
    ScoreError
        If there is no such criterion, or it is a criterion of 3D models.
    """
    if name.lower() == CUES:
        preset = score_preset_named("default")
        criteria = tuple(criteria_named(preset.criteria))
        return SearchObjective(criteria, OBJECTIVES["efficiency"], preset.settings)
    [criterion] = criteria_named([name])
    if criterion.reconstruction:
        raise ScoreError(
            f"{criterion.name} is a figure of 3D models, which a search does not make; choose a "
            "criterion of image pairs, such as excess_inliers"
        )
    return SearchObjective((criterion,))


def threshold_objective() -> SearchObjective:
    """The objective of searches for inlier thresholds."""
    return SearchObjective((GEOMETRY,))


def mean_gain(gains: Array, scenes: Sequence[Hashable]) -> tuple[float, float, float]:
    """Mean gain over pairs with its 95 % interval (Student's t).

    The gains of pairs of one scene are correlated. With three or more scenes the interval therefore
    comes from the spread of the means of the scenes, weighted by their numbers of pairs, and
    generalises to other scenes. With fewer scenes it comes from the pairs and holds only for these
    scenes.

    Parameters
    ----------
    gains : (P,) float64
        Gains of at least two pairs.
    scenes : sequence of hashable
        The scene of each pair.
    """
    # scipy.stats.t has the same quantiles, but takes most of a second to load.
    from scipy.special import stdtrit

    groups, weights = gains, np.full(len(gains), 1 / len(gains))
    names = list(dict.fromkeys(scenes))
    if len(names) >= FEWEST_SCENES:
        member = np.array([[scene == name for name in names] for scene in scenes], np.float64)
        weights = member.mean(axis=0)
        groups = gains @ member / member.sum(axis=0)
    mean = float(gains.mean())
    error = groups.std(ddof=1) * np.sqrt((weights**2).sum())
    reach = float(stdtrit(len(groups) - 1, 0.975) * error)
    return mean, mean - reach, mean + reach
