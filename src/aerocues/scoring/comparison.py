"""Compares rankings of the same alternatives on several datasets."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
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
        Names of the rankings.
    alternatives : tuple of str
        All alternatives with a score in at least one ranking, sorted by name.
    scores : (rankings, alternatives) float64
        NaN where an alternative has no score.
    over : {"pairwise", "all"}
        Whether two rankings are compared over the alternatives scored in both, or over those
        scored in all rankings.
    datasets : tuple of str
        Dataset of each ranking. For versatility, several rankings of one dataset (by several
        machines) count once, with their mean.
    components : mapping of str to tuple of str
        Labels of each alternative, by component; see `DecisionTable`.
    """

    names: tuple[str, ...]
    alternatives: tuple[str, ...]
    scores: Array
    over: Over
    datasets: tuple[str, ...]
    components: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    def _compared(self) -> Array:
        in_all = ~np.isnan(self.scores).any(axis=0)
        return self.scores[:, in_all] if self.over == "all" else self.scores

    def spearman(self) -> Array:
        """(rankings, rankings) Spearman's rank correlation; NaN where undefined."""
        return rank_correlation(self._compared())

    def kendall(self) -> Array:
        """(rankings, rankings) Kendall's tau-b; NaN where undefined."""
        return rank_correlation(self._compared(), "kendall")

    def shared(self) -> NDArray[np.int64]:
        """(rankings, rankings) number of alternatives behind each correlation."""
        known = (~np.isnan(self._compared())).astype(np.int64)
        return np.asarray(known @ known.T)

    def ranks(self) -> Array:
        """(rankings, alternatives) rank in each ranking; NaN without a score."""
        return rank(self.scores)

    def versatility(self) -> pl.DataFrame:
        """Scores and ranks of each alternative over all datasets, the best mean first.

        Returns
        -------
        pl.DataFrame
            ``alternative``; ``mean, min, spread`` (largest minus smallest) and
            ``standard_deviation`` of its scores over the datasets; ``mean_rank, worst_rank``;
            ``datasets`` (number of datasets with a score); then ``score_NAME`` and ``rank_NAME``
            for each ranking. Alternatives scored on all datasets come first.
        """
        import polars as pl

        scores, ranks = self.by_dataset(self.scores), self.by_dataset(self.ranks())
        named = {f"score_{name}": row for name, row in zip(self.names, self.scores, strict=True)}
        named |= {f"rank_{name}": row for name, row in zip(self.names, self.ranks(), strict=True)}
        frame = pl.DataFrame(
            {
                "alternative": self.alternatives,
                "mean": np.nanmean(scores, axis=0),
                "min": np.nanmin(scores, axis=0),
                "spread": np.nanmax(scores, axis=0) - np.nanmin(scores, axis=0),
                "standard_deviation": np.nanstd(scores, axis=0),
                "mean_rank": np.nanmean(ranks, axis=0),
                "worst_rank": np.nanmax(ranks, axis=0),
                "datasets": (~np.isnan(scores)).sum(axis=0),
                **named,
            },
            nan_to_null=True,
        )
        return frame.sort("datasets", "mean", "alternative", descending=[True, True, False])

    @property
    def dataset_names(self) -> tuple[str, ...]:
        """Each dataset once, in the order of `by_dataset`."""
        return tuple(dict.fromkeys(self.datasets))

    def by_dataset(self, values: Array) -> Array:
        """(datasets, alternatives) mean over the rankings of each dataset, or NaN."""
        rows = []
        for dataset in self.dataset_names:
            chosen = values[[each == dataset for each in self.datasets]]
            known = ~np.isnan(chosen)
            total, number = np.where(known, chosen, 0).sum(axis=0), known.sum(axis=0)
            mean = np.full(values.shape[1], np.nan)
            rows.append(np.divide(total, number, out=mean, where=number > 0))
        return np.stack(rows)


def compare(
    rankings: Mapping[str, Scores],
    over: Over = "pairwise",
    datasets: Sequence[str] | None = None,
) -> Comparison:
    """Put rankings side by side.

    Parameters
    ----------
    rankings : mapping of str to Scores
        At least two, by the name of the dataset.
    over : {"pairwise", "all"}
        Over which alternatives two rankings are compared; see `Comparison`.
    datasets : sequence of str, optional
        Dataset of each ranking; by default the ranking's name.

    Raises
    ------
    ScoreError
        If there is only one ranking, or no two rankings share an alternative.
    """
    if len(rankings) < 2:
        raise ScoreError("a comparison needs at least two results")
    if over not in ("pairwise", "all"):
        raise ScoreError(f"over must be pairwise or all, got {over!r}")
    scored = {
        name: {
            scores.table.alternatives[position]: scores.scores[position]
            for position in scores.order
        }
        for name, scores in rankings.items()
    }
    alternatives = sorted(set().union(*scored.values()))
    table = [[each.get(name, np.nan) for name in alternatives] for each in scored.values()]
    comparison = Comparison(
        names=tuple(scored),
        alternatives=tuple(alternatives),
        scores=np.array(table),
        over=over,
        datasets=tuple(datasets or scored),
        components=_components(rankings.values(), alternatives),
    )
    shared = comparison.shared()
    np.fill_diagonal(shared, 0)
    if not shared.any():
        raise ScoreError("no two results share an alternative, so there is nothing to compare")
    return comparison


def _components(
    rankings: Iterable[Scores], alternatives: Sequence[str]
) -> dict[str, tuple[str, ...]]:
    """Labels of the alternatives, by the components that all rankings have."""
    tables = [scores.table for scores in rankings]
    found = {}
    for component in tables[0].components:
        if all(component in table.components for table in tables):
            labels: dict[str, str] = {}
            for table in tables:
                labels |= zip(table.alternatives, table.components[component], strict=True)
            found[component] = tuple(labels[name] for name in alternatives)
    return found
