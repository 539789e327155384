"""What a race found."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from aerocues.datasets.dataset import Dataset
from aerocues.methods.presets import Preset
from aerocues.notebooks import as_html
from aerocues.phrases import count, likelihood
from aerocues.pipeline.equal_footing import Footing
from aerocues.scoring.objectives import Objective
from aerocues.tuning.flight_pairs import SurveyedFlight
from aerocues.tuning.race import RaceOutcome
from aerocues.tuning.representative import Seen

if TYPE_CHECKING:
    import polars as pl


@dataclass(frozen=True, eq=False)
class Recommendation:
    """What a race found.

    Parameters
    ----------
    dataset : Dataset
        With the pairs that stood for all.
    seen : Seen
    candidates : int
        Pairs of the whole data set.
    objective : Objective
    outcome : RaceOutcome
    ranked : pl.DataFrame
        One row a combination that was measured with success, the best first: ``combination,
        score, probability, pairs, succeeded``, medians over its pairs of
        ``precision_beyond_chance, excess_inliers, ref_precision@3, ref_matches@3, coverage,
        total_seconds`` and of the stages, one image
        each: ``detect_seconds, describe_seconds, match_seconds, verify_seconds``.
    combinations, measured : int
        How many raced, and how many of them were measured at all.
    folder : Path
        With all that was measured.
    machine : str
        Whose times count.
    preset : Preset
        Of the methods, with the thresholds that were lowered to reach a number of keypoints.
    footings : tuple of Footing
        What became of each detector's threshold; empty where nothing was to be reached.
    flight : SurveyedFlight or None
        What a survey saw, where pairs were chosen by one.
    """

    dataset: Dataset
    seen: Seen
    candidates: int
    objective: Objective
    outcome: RaceOutcome
    ranked: pl.DataFrame
    combinations: int
    measured: int
    folder: Path
    machine: str
    preset: Preset
    footings: tuple[Footing, ...] = ()
    flight: SurveyedFlight | None = None

    def __repr__(self) -> str:
        chance = likelihood(float(self.ranked["probability"][0]))
        return (
            f"Recommendation: take {self.best}, the best of {self.combinations:,} for "
            f"{self.objective.title} on {self.dataset.name} with a probability of {chance}; "
            f"{count(int(self.outcome.known.sum()), 'measurement')} on "
            f"{count(len(self.seen.overlapping), 'pair')} in {self.folder}"
        )

    def _repr_html_(self) -> str:
        return as_html(repr(self), self.ranked)

    @property
    def best(self) -> str:
        """The combination to take."""
        return str(self.ranked["combination"][0])
