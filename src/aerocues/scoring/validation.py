"""All examinations of how robust a ranking is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from aerocues.defaults import SHORTLIST
from aerocues.errors import MethodUnavailableError, ScoreError
from aerocues.phrases import count
from aerocues.scoring.agreement import Agreement, agreement
from aerocues.scoring.correlation import correlation_frame, criteria_correlation
from aerocues.scoring.cues import Scores
from aerocues.scoring.friedman import CriticalDifference, critical_difference
from aerocues.scoring.hierarchy import hierarchy
from aerocues.scoring.matcher_times import matcher_times
from aerocues.scoring.pareto import pareto_of_criteria
from aerocues.scoring.rank_reversal import RankReversal, rank_reversal
from aerocues.scoring.sensitivity import Variants, by_aggregation, by_alpha, by_criterion_left_out

if TYPE_CHECKING:
    import polars as pl

# Axes of the Pareto front: the first criterion of each list that the table has.
SPEED = (
    "seconds_per_1k_ref_matches",
    "seconds_per_1k_excess_inliers",
    "seconds_per_1k_inliers",
    "seconds_per_1k_matches",
    "total_seconds",
)
QUALITY = ("ref_precision@3", "precision_beyond_chance", "precision", "f1_score", "inliers")


@dataclass(frozen=True)
class Validation:
    """The result of `validate`.

    Attributes
    ----------
    scores : Scores
        What was examined.
    alpha, aggregation, criterion_left_out : Variants
    agreement : Agreement or str
        A text says why it is not available.
    criteria_correlation : (criteria, criteria) float64
        Pearson's correlation.
    hierarchies : dict of pl.DataFrame
        By component.
    matcher_times : mapping of str to pl.DataFrame
        Speed with each matcher against brute force, by component; see `matcher_times`.
    pareto_criteria : tuple of str
        Speed and quality; empty if the table has no such criteria.
    pareto_front : (alternatives on the front,) int64
        Indices, the fastest first.
    rank_reversal : RankReversal or None
        None with a single alternative.
    critical_difference : CriticalDifference or str
        For the shortlist; a text says why it is not available.
    """

    scores: Scores
    alpha: Variants
    aggregation: Variants
    criterion_left_out: Variants
    agreement: Agreement | str
    criteria_correlation: NDArray[np.float64]
    hierarchies: dict[str, pl.DataFrame]
    matcher_times: Mapping[str, pl.DataFrame]
    pareto_criteria: tuple[str, ...]
    pareto_front: NDArray[np.int64]
    rank_reversal: RankReversal | None
    critical_difference: CriticalDifference | str

    def __repr__(self) -> str:
        scores = self.scores
        best = scores.table.alternatives[scores.best]
        same = self.alpha.best.count(best)
        return (
            f"Validation of {count(len(scores.order), 'combination')} by "
            f"{', '.join(scores.table.criterion_names)}; {best} is the best under "
            f"{same} of {len(self.alpha.best)} powers alpha"
        )

    def tables(self, top: int = SHORTLIST) -> dict[str, pl.DataFrame]:
        """All tables by their titles, for a paper; lists of alternatives have `top` rows.

        Returns
        -------
        dict of pl.DataFrame
            The first column of each table names its rows.
        """
        import polars as pl

        table = self.scores.table
        found = {
            "Power alpha: Spearman's correlation": _of_variants(self.alpha),
            "Aggregation of the weights: Spearman's correlation": _of_variants(self.aggregation),
            "Criteria left out: Spearman's correlation": _of_variants(self.criterion_left_out),
        }
        if not isinstance(self.agreement, str):
            found["Other methods: Spearman's correlation"] = _of_variants(self.agreement)
        found["Criteria: Pearson's correlation"] = correlation_frame(
            table.criterion_names, self.criteria_correlation
        )
        found |= {f"Scores of {name}": frame.head(top) for name, frame in self.hierarchies.items()}
        speed = self.pareto_criteria[0] if self.pareto_criteria else ""
        found |= {
            f"Matchers by {name}: {speed}": frame for name, frame in self.matcher_times.items()
        }
        if self.pareto_criteria:
            columns = [table.criterion_names.index(name) for name in self.pareto_criteria]
            found["Pareto front"] = pl.DataFrame(
                {
                    "name": [table.alternatives[position] for position in self.pareto_front],
                    **{
                        name: self.scores.means[self.pareto_front, column]
                        for name, column in zip(self.pareto_criteria, columns, strict=True)
                    },
                    "rank": self.scores.ranks[self.pareto_front],
                }
            )
        if not isinstance(self.critical_difference, str):
            each = self.critical_difference
            found[f"Mean ranks (critical difference {each.critical_difference:.2f})"] = (
                pl.DataFrame({"name": each.alternatives, "mean rank": each.mean_ranks})
            )
        return found


def _of_variants(found: Variants | Agreement) -> pl.DataFrame:
    import polars as pl

    frame = correlation_frame(found.names, found.correlation)
    return frame.with_columns(pl.Series("the best", list(found.best)))


def validate(
    scores: Scores,
    *,
    speed: str | None = None,
    quality: str | None = None,
    shortlist: int = SHORTLIST,
    seed: int = 0,
) -> Validation:
    """Examine a ranking as in the thesis, and further.

    Parameters
    ----------
    scores : Scores
    speed, quality : str, optional
        Criteria of the Pareto front; by default the first of `SPEED` and `QUALITY` that the table
        has.
    shortlist : int
        Number of best alternatives in Friedman's test.
    seed : int

    Raises
    ------
    ScoreError
        If a criterion is not in the table.
    """
    chosen = _pareto_criteria(scores, speed, quality)
    return Validation(
        scores=scores,
        alpha=by_alpha(scores),
        aggregation=by_aggregation(scores),
        criterion_left_out=by_criterion_left_out(scores),
        agreement=_agreement(scores),
        criteria_correlation=criteria_correlation(scores),
        hierarchies=hierarchy(scores),
        matcher_times=matcher_times(scores, chosen[0]) if chosen else {},
        pareto_criteria=chosen,
        pareto_front=pareto_of_criteria(scores, *chosen) if chosen else np.array([], np.int64),
        rank_reversal=rank_reversal(scores, seed=seed) if len(scores.order) > 1 else None,
        critical_difference=_critical_difference(scores, shortlist),
    )


def _pareto_criteria(
    scores: Scores, speed: str | None, quality: str | None
) -> tuple[str, str] | tuple[()]:
    names = scores.table.criterion_names
    first = speed or next((name for name in SPEED if name in names), None)
    second = quality or next((name for name in QUALITY if name in names), None)
    return (first, second) if first and second else ()


def _agreement(scores: Scores) -> Agreement | str:
    try:
        return agreement(scores)
    except MethodUnavailableError as error:
        return str(error)


def _critical_difference(scores: Scores, shortlist: int) -> CriticalDifference | str:
    try:
        return critical_difference(scores, scores.order[:shortlist].tolist())
    except ScoreError as error:
        return str(error)
