"""Rankings of the same alternatives on several data sets: how stable, and who is versatile."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from aerocues.errors import ScoreError
from aerocues.scoring.correlation import rank_correlation
from aerocues.scoring.cues import Scores, rank

if TYPE_CHECKING:
    import polars as pl

Array = NDArray[np.float64]
Over = Literal["pairwise", "all"]


@dataclass(frozen=True)
class Comparison:
    """Several rankings side by side.

    Attributes
    ----------
    names : tuple of str
        Of the rankings.
    alternatives : tuple of str
        All that have a score in one ranking at least, by name.
    scores : (rankings, alternatives) float64
        NaN where an alternative has no score.
    over : {"pairwise", "all"}
        Whether two rankings are compared over the alternatives scored in both, or over those
        scored in all rankings.
    """

    names: tuple[str, ...]
    alternatives: tuple[str, ...]
    scores: Array
    over: Over

    def _compared(self) -> Array:
        in_all = ~np.isnan(self.scores).any(axis=0)
        return self.scores[:, in_all] if self.over == "all" else self.scores

    def spearman(self) -> Array:
        """(rankings, rankings) Spearman's rank correlation; NaN where it is not defined."""
        return rank_correlation(self._compared())

    def kendall(self) -> Array:
        """(rankings, rankings) Kendall's tau-b; NaN where it is not defined."""
        return rank_correlation(self._compared(), "kendall")

    def shared(self) -> NDArray[np.int64]:
        """(rankings, rankings) number of alternatives that two rankings are compared over."""
        known = (~np.isnan(self._compared())).astype(np.int64)
        return np.asarray(known @ known.T)

    def versatility(self) -> pl.DataFrame:
        """How good each alternative is over all rankings, the best mean first.

        Returns
        -------
        pl.DataFrame
            ``alternative``; ``mean, min, spread`` (largest minus smallest score) and
            ``standard_deviation`` of its scores; ``mean_rank, worst_rank`` among all that have a
            score in a ranking; ``rankings`` (in how many it has one); then its score in each.
            Alternatives scored in all rankings come first.
        """
        import polars as pl

        known = ~np.isnan(self.scores)
        ranks = rank(self.scores)
        frame = pl.DataFrame(
            {
                "alternative": self.alternatives,
                "mean": np.nanmean(self.scores, axis=0),
                "min": np.nanmin(self.scores, axis=0),
                "spread": np.nanmax(self.scores, axis=0) - np.nanmin(self.scores, axis=0),
                "standard_deviation": np.nanstd(self.scores, axis=0),
                "mean_rank": np.nanmean(ranks, axis=0),
                "worst_rank": np.nanmax(ranks, axis=0),
                "rankings": known.sum(axis=0),
                **dict(zip(self.names, self.scores, strict=True)),
            },
            nan_to_null=True,
        )
        return frame.sort("rankings", "mean", "alternative", descending=[True, True, False])


def compare(rankings: Mapping[str, Scores], over: Over = "pairwise") -> Comparison:
    """Put rankings side by side.

    Parameters
    ----------
    rankings : mapping of str to Scores
        By the name of the data set, two or more.
    over : {"pairwise", "all"}
        Which alternatives two rankings are compared over; see `Comparison`.

    Raises
    ------
    ScoreError
        If there is one ranking only, or none shares an alternative with another.
    """
    if len(rankings) < 2:
        raise ScoreError("one ranking cannot be compared; give two results or more")
    if over not in ("pairwise", "all"):
        raise ScoreError(f"cannot compare over {over!r}; choose pairwise or all")
    scored = {
        name: {
            scores.table.alternatives[position]: scores.scores[position]
            for position in scores.order
        }
        for name, scores in rankings.items()
    }
    alternatives = sorted(set().union(*scored.values()))
    table = [[each.get(name, np.nan) for name in alternatives] for each in scored.values()]
    comparison = Comparison(tuple(scored), tuple(alternatives), np.array(table), over)
    shared = comparison.shared()
    np.fill_diagonal(shared, 0)
    if not shared.any():
        raise ScoreError("no alternative is in two of the results; there is nothing to compare")
    return comparison
