"""What the rankings of several datasets say together."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from aerocues.scoring.comparison import Comparison
from aerocues.scoring.correlation import correlation_frame
from aerocues.scoring.cues import Scores
from aerocues.scoring.hierarchy import hierarchy_across
from aerocues.scoring.leaders import best_of_each, consistently_good, kept_in_top
from aerocues.scoring.sensitivity import Variants, by_aggregation, by_alpha, mean_correlation

if TYPE_CHECKING:
    import polars as pl

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Overview:
    """Several datasets together.

    Attributes
    ----------
    datasets : tuple of str
    evaluations : int
        Scores: combinations x datasets.
    mean_correlation : float
        Mean of Spearman's rank correlation over all pairs of datasets.
    best : pl.DataFrame
        See `leaders.best_of_each`.
    kept : (datasets, datasets) int64
        See `leaders.kept_in_top`.
    consistent : pl.DataFrame
        See `leaders.consistently_good`.
    hierarchies : mapping of str to pl.DataFrame
        See `hierarchy.hierarchy_across`.
    alpha, aggregation : Variants
        Means over the datasets; without the best, which differs.
    """

    datasets: tuple[str, ...]
    evaluations: int
    mean_correlation: float
    best: pl.DataFrame
    kept: NDArray[np.int64]
    consistent: pl.DataFrame
    hierarchies: Mapping[str, pl.DataFrame]
    alpha: Variants
    aggregation: Variants

    @property
    def mean_of_bests(self) -> float:
        """Mean score of the best of each dataset."""
        return float(self.best["score"].to_numpy().mean())

    @property
    def range_of_bests(self) -> float:
        """Largest minus smallest score of the best of each dataset."""
        return float(np.ptp(self.best["score"].to_numpy()))

    def tables(self) -> dict[str, pl.DataFrame]:
        """All tables by their titles, for a paper."""
        import polars as pl

        columns = dict(zip(self.datasets, self.kept.T, strict=True))
        return {
            "Best of each dataset": self.best,
            "Kept in the first ten": pl.DataFrame({"name": self.datasets, **columns}),
            "Consistently good": self.consistent.rename({"alternative": "combination"}),
            **{f"Scores of {name}": frame for name, frame in self.hierarchies.items()},
            "Power alpha, mean over the datasets": correlation_frame(
                self.alpha.names, self.alpha.correlation
            ),
            "Aggregation of the weights, mean over the datasets": correlation_frame(
                self.aggregation.names, self.aggregation.correlation
            ),
        }


def overview_of(rankings: Sequence[Scores], comparison: Comparison) -> Overview:
    """Put the rankings of several datasets together.

    Parameters
    ----------
    rankings : sequence of Scores
        One for each dataset: the sensitivity is examined in them.
    comparison : Comparison
        Of all rankings.
    """
    scores = comparison.by_dataset(comparison.scores)
    correlation = comparison.spearman()
    of = np.array(comparison.datasets)
    different = of[:, None] != of[None, :]
    return Overview(
        datasets=comparison.dataset_names,
        evaluations=int((~np.isnan(scores)).sum()),
        mean_correlation=_mean_of_known(correlation[different]),
        best=best_of_each(comparison),
        kept=kept_in_top(comparison),
        consistent=consistently_good(comparison),
        hierarchies=hierarchy_across(comparison),
        alpha=_mean([by_alpha(each) for each in rankings]),
        aggregation=_mean([by_aggregation(each) for each in rankings]),
    )


def _mean_of_known(values: NDArray[np.float64]) -> float:
    """NaN where nothing is known: so few combinations that none correlate."""
    known = values[~np.isnan(values)]
    return float(known.mean()) if len(known) else math.nan


def _mean(found: Sequence[Variants]) -> Variants:
    return Variants(found[0].names, mean_correlation(found), ())
