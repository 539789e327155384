"""What a race found."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from aerocues.datasets.dataset import Dataset
from aerocues.methods.presets import Preset
from aerocues.notebooks import as_html
from aerocues.phrases import count, likelihood
from aerocues.pipeline.equal_footing import Footing
from aerocues.pipeline.flight_pairs import SurveyedFlight
from aerocues.results.combination_columns import name_in_row
from aerocues.scoring.objectives import Objective
from aerocues.tuning.final import Final
from aerocues.tuning.race import RaceOutcome
from aerocues.tuning.representative import Seen

if TYPE_CHECKING:
    import polars as pl

RECORDED = 40
"""Combinations whose probability is kept for reports: users see the best of them."""


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
    final : Final or None
        Models of the leaders, where there was time for them.
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
    final: Final | None = None

    def __repr__(self) -> str:
        chance = self.likelihood(float(self.ranked["probability"][0]))
        how = "by the models of the leaders; " if self.best != self.leader else ""
        return (
            f"Recommendation: take {self.best}; {how}{self.leader} is the best of "
            f"{self.combinations:,} for {self.objective.title} on pairs of {self.dataset.name} "
            f"with a probability of {chance}; "
            f"{count(int(self.outcome.known.sum()), 'measurement')} on "
            f"{count(len(self.seen.overlapping), 'pair')} in {self.folder}"
        )

    def _repr_html_(self) -> str:
        return as_html(repr(self), self.ranked)

    @property
    def readable(self) -> float:
        """Share of the images, or of the tested pairs, that could be read and measured."""
        if self.flight:
            survey = self.flight.survey
            return 1 - len(survey.unreadable) / len(survey.images)
        seen = self.seen
        tested = len(seen.overlapping) + len(seen.others) + len(seen.failed)
        return 1 - len(seen.failed) / tested

    def likelihood(self, probability: float) -> str:
        """A probability in words; never more than the share of the images that could be read."""
        return likelihood(min(probability, self.readable))

    @property
    def leader(self) -> str:
        """The combination with the highest expected score in the race."""
        return str(self.ranked["combination"][0])

    @property
    def best(self) -> str:
        """What to take: the best model's combination or COLMAP's default; else the leader."""
        row = self.final.best if self.final else None
        return name_in_row(row) if row else self.leader

    def facts(self) -> dict[str, Any]:
        """What a report tells of it, in JSON types."""
        rows = self.ranked.select("combination", "score", "probability", "pairs", "succeeded")
        final = self.final
        return {
            "dataset": self.dataset.name,
            "objective": self.objective.name,
            "title": self.objective.title,
            "best": self.best,
            "leader": self.leader,
            "probability": min(float(self.ranked["probability"][0]), self.readable),
            "ended": self.outcome.ended,
            "seconds": self.outcome.rounds[-1].spent,
            "combinations": self.combinations,
            "measured": self.measured,
            "measurements": int(self.outcome.known.sum()),
            "pairs": len(self.seen.overlapping),
            "candidates": self.candidates,
            "ranked": rows.head(RECORDED).to_dicts(),
            "final": final
            and {
                "images": final.images,
                "of": final.of,
                "order": list(final.order),
                "models": [name_in_row(row) for row in final.rows],
                "unfinished": list(final.unfinished),
            },
        }
