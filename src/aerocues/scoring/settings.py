"""Settings of the score, and presets of them: one row each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from aerocues.errors import ScoreError
from aerocues.scoring.aggregation import AGGREGATIONS
from aerocues.scoring.weights import WEIGHT_METHODS

Names = str | Sequence[str]
"""Names one by one, or in a text with commas."""
Failures = Literal["worst", "omit"]
FAILURES: tuple[Failures, ...] = ("worst", "omit")
Bounds = Literal["measured", "positive", "zero"]
BOUNDS: tuple[Bounds, ...] = ("measured", "positive", "zero")


def names_of(names: Names) -> tuple[str, ...]:
    """Names one by one."""
    parts = names.split(",") if isinstance(names, str) else names
    return tuple(name.strip() for name in parts if name.strip())


def _check(name: str, what: str, choices: tuple[str, ...]) -> None:
    if name not in choices:
        raise ScoreError(f"there is no {what} {name!r}; choose from {', '.join(choices)}")


@dataclass(frozen=True)
class ScoreSettings:
    """Settings of the Composite Unsupervised Efficiency Score (CUES).

    Attributes
    ----------
    alpha : float
        Exponent of the normalised values, above 0; below 1 it raises small values.
    weights : tuple of str
        Names of rows of `weights.WEIGHT_METHODS`.
    aggregation : str
        Aggregation of the weights of the methods: a row of `aggregation.AGGREGATIONS`.
    failures : {"worst", "omit"}
        Whether a failed repeat counts as the worst value of each criterion, or not at all.
    bounds : {"measured", "positive", "zero"}
        Whether values are normalised by the smallest and largest measured ones, by the smallest
        above 0 and the largest, or by 0 and the largest: for criteria whose ratios are to count.
    needs_first : bool
        Whether an alternative has no score if it failed on the first repeat. Its measurements
        count for the bounds nevertheless.

    Raises
    ------
    ScoreError
        If a value is out of range or a name does not exist.
    """

    alpha: float = 0.5
    weights: tuple[str, ...] = ("entropy", "variance", "critic", "pca")
    aggregation: str = "arithmetic"
    failures: Failures = "worst"
    bounds: Bounds = "measured"
    needs_first: bool = False

    def __post_init__(self) -> None:
        if not 0 < self.alpha < float("inf"):
            raise ScoreError(f"alpha must be above 0, such as 0.5; got {self.alpha}")
        if not self.weights:
            raise ScoreError(f"weights must name at least one of {', '.join(WEIGHT_METHODS)}")
        for name in self.weights:
            _check(name, "method of weighting", tuple(WEIGHT_METHODS))
            if self.weights.count(name) > 1:
                raise ScoreError(f"the method of weighting {name} is given twice; give it once")
        _check(self.aggregation, "aggregation", tuple(AGGREGATIONS))
        _check(self.failures, "treatment of failures", FAILURES)
        _check(self.bounds, "kind of bounds", BOUNDS)


@dataclass(frozen=True)
class ScorePreset:
    """A named way of scoring combinations.

    Attributes
    ----------
    name : str
    criteria : tuple of str
        Names of rows of `criteria.CRITERIA`.
    settings : ScoreSettings
    chance_fails : bool
        Whether a pair has failed if its model is not better than chance.
    description : str
    reconstruction_criteria : tuple of str
        Names of rows that are added where there are reconstructions.
    links : bool
        Whether scores are multiplied by how surely pairs of each class are linked; see
        `links.Links`.
    """

    name: str
    criteria: tuple[str, ...]
    settings: ScoreSettings
    chance_fails: bool
    description: str
    reconstruction_criteria: tuple[str, ...] = (
        "reprojection_error",
        "points_3d",
        "reconstruction_seconds",
    )
    links: bool = False


_OF_THE_THESIS = (
    "recall",
    "precision",
    "repeatability",
    "f1_score",
    "inliers",
    "matches",
    "seconds_per_1k_matches",
    "seconds_per_1k_inliers",
)
REPRODUCING = "published"
"""The preset that is there to reproduce figures."""
_ITS_WEIGHTS = ("entropy", "variance", "critic_published", "pca")

SCORE_PRESETS: dict[str, ScorePreset] = {
    preset.name: preset
    for preset in (
        ScorePreset(
            "default",
            (
                "ref_matching_score@3",
                "ref_precision@3",
                "ref_repeatability",
                "ref_matches@3",
                "coverage",
                "sharpness",
                "seconds_per_1k_ref_matches",
            ),
            ScoreSettings(),
            chance_fails=True,
            description="matches that are right by the reference, times the links of each class of "
            "pairs; a failed pair counts as the worst",
            links=True,
        ),
        ScorePreset(
            "models",
            ("expected_quality",),
            ScoreSettings(alpha=1.0, bounds="zero"),
            chance_fails=True,
            description="what leads to good 3D models: many right matches, and exact ones, times "
            "the links of each class of pairs",
            links=True,
        ),
        ScorePreset(
            "inliers",
            (
                "recall_beyond_chance",
                "precision_beyond_chance",
                "repeatability_beyond_chance",
                "f1_beyond_chance",
                "excess_inliers",
                "matches",
                "seconds_per_1k_matches",
                "seconds_per_1k_excess_inliers",
            ),
            ScoreSettings(),
            chance_fails=True,
            description="inliers beyond chance; a failed pair counts as the worst",
        ),
        ScorePreset(
            "thesis",
            _OF_THE_THESIS,
            ScoreSettings(weights=_ITS_WEIGHTS, failures="omit"),
            chance_fails=False,
            description="as published: raw inliers, failed pairs left out, CRITIC with a diagonal",
        ),
        ScorePreset(
            REPRODUCING,
            _OF_THE_THESIS,
            ScoreSettings(
                weights=_ITS_WEIGHTS, failures="omit", bounds="positive", needs_first=True
            ),
            chance_fails=False,
            description="as thesis, with what made its published figures besides: lower bounds "
            "above 0, no score for what failed on the first pair",
        ),
    )
}


def score_preset_named(name: str) -> ScorePreset:
    """The preset of this name; ScoreError if there is none."""
    _check(name, "preset of scoring", tuple(SCORE_PRESETS))
    return SCORE_PRESETS[name]
