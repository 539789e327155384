"""Scores of one dataset on two machines, each normalised by itself, by combination and method."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from aerocues.errors import ScoreError
from aerocues.scoring.comparison import Comparison, compare
from aerocues.scoring.cues import Scores
from aerocues.scoring.leaders import TOP, kept_in_top

if TYPE_CHECKING:
    import polars as pl


@dataclass(frozen=True)
class PlatformScores:
    """What changes from one machine to another.

    Attributes
    ----------
    combinations : pl.DataFrame
        ``combination, first_score, second_score, difference`` (second minus first) and
        ``first_rank, second_rank``, the best of the first machine first.
    components : mapping of str to pl.DataFrame
        By component: ``name, first_mean, second_mean, difference, combinations``.
    kept : int
        How many of the first ten on one machine are among them on the other.
    spearman : float
        Rank correlation of the scores.
    largest : float
        Largest absolute difference of a score.
    """

    combinations: pl.DataFrame
    components: Mapping[str, pl.DataFrame]
    kept: int
    spearman: float
    largest: float

    def tables(self, between: str) -> dict[str, pl.DataFrame]:
        """All tables by their titles, for a paper."""
        return {
            f"Machines, {between}": self.combinations,
            **{f"Machines by {name}, {between}": frame for name, frame in self.components.items()},
        }


def platform_scores(first: Scores, second: Scores) -> PlatformScores | str:
    """Compare the scores of two machines; a text says why they cannot be compared."""
    try:
        both = compare({"first": first, "second": second}, "all")
    except ScoreError as error:
        return str(error)
    frame = _by_combination(both)
    return PlatformScores(
        combinations=frame.drop(both.components),
        components={name: _by_component(frame, name) for name in both.components},
        kept=int(kept_in_top(both, TOP)[0, 1]),
        spearman=float(both.spearman()[0, 1]),
        largest=float(np.abs(frame["difference"].to_numpy()).max()),
    )


def _by_combination(both: Comparison) -> pl.DataFrame:
    import polars as pl

    ranks = both.ranks()
    return (
        pl.DataFrame(
            {
                "combination": both.alternatives,
                "first_score": both.scores[0],
                "second_score": both.scores[1],
                "difference": both.scores[1] - both.scores[0],
                "first_rank": ranks[0],
                "second_rank": ranks[1],
                **both.components,
            },
            nan_to_null=True,
        )
        .drop_nulls("difference")
        .sort("first_rank", "combination")
    )


def _by_component(frame: pl.DataFrame, component: str) -> pl.DataFrame:
    import polars as pl

    return (
        frame.group_by(pl.col(component).alias("name"))
        .agg(
            pl.col("first_score").mean().alias("first_mean"),
            pl.col("second_score").mean().alias("second_mean"),
            pl.col("difference").mean(),
            pl.len().alias("combinations"),
        )
        .sort("first_mean", "name", descending=[True, False])
    )
