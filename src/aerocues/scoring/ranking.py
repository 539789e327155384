"""The ranking, with its uncertainty."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from aerocues.arguments import check_choice, check_whole
from aerocues.defaults import RESAMPLES, TOP_K
from aerocues.errors import ScoreError
from aerocues.notebooks import as_html
from aerocues.phrases import count, likelihood
from aerocues.scoring.bootstrap import Bootstrap, bootstrap
from aerocues.scoring.cues import Scores, score
from aerocues.scoring.per_repeat import interval_of_repeats
from aerocues.scoring.settings import ScoreSettings
from aerocues.scoring.significance import LEVEL, Comparisons, compare_with_one
from aerocues.scoring.table import DecisionTable

if TYPE_CHECKING:
    import polars as pl

Array = NDArray[np.float64]
Interval = Literal["joint", "pairwise"]

INTERVALS: dict[str, Callable[[Scores, Bootstrap, int], tuple[Array, Array]]] = {
    "joint": lambda scores, resampled, seed: resampled.score_interval(),
    "pairwise": lambda scores, resampled, seed: interval_of_repeats(
        scores, len(resampled.scores), seed
    ),
}


@dataclass(frozen=True)
class Ranking:
    """Ranked alternatives with intervals, probabilities and significance.

    Attributes
    ----------
    scores : Scores
    resampled : Bootstrap
    comparisons : Comparisons
    seed : int
    interval : {"joint", "pairwise"}
        Score interval: joint resampling of all alternatives, or pairwise as in the thesis.
    top_k : int
        Number of first places that ``probability_top`` counts.
    noun : str
        What the alternatives are.
    """

    scores: Scores
    resampled: Bootstrap
    comparisons: Comparisons
    seed: int
    interval: Interval
    top_k: int
    noun: str = "alternative"

    def __repr__(self) -> str:
        scores = self.scores
        names = scores.table.alternatives
        told = f"Ranking: {count(len(scores.order), self.noun)} by CUES"
        if not len(scores.order):
            return told
        best = names[scores.best]
        equal = len(set(self.indistinguishable()) - {best})
        chance = likelihood(float(self.resampled.probability_best()[scores.best]))
        others = f"; {equal} more cannot be told from it" if equal else ""
        value = f"{scores.scores[scores.best]:.3f}"
        return f"{told}; {best} is the best ({value}) with a probability of {chance}{others}"

    def _repr_html_(self) -> str:
        return as_html(repr(self), self.frame())

    def frame(self, name: str | None = None) -> pl.DataFrame:
        """The ranking as a table, the best first, without alternatives that have no score.

        Parameters
        ----------
        name : str, optional
            Name of the column of alternatives; their `noun` by default.

        Returns
        -------
        pl.DataFrame
            `name`; ``rank``, ``rank_low``, ``rank_high`` and ``score``, ``score_low``,
            ``score_high`` (95 %); ``probability_best``, ``probability_top``; ``p_value`` of the
            difference from `against` (corrected; null for itself); ``success_rate``;
            number of measured ``repeats``; and the mean of each criterion over its valid repeats.

        Raises
        ------
        ScoreError
            If a criterion has the same name as another column.
        """
        import polars as pl

        name, scores, table = name or self.noun, self.scores, self.scores.table
        low, high = INTERVALS[self.interval](scores, self.resampled, self.seed)
        rank_low, rank_high = self.resampled.rank_interval()
        figures: dict[str, Any] = {
            name: table.alternatives,
            "rank": scores.ranks,
            "rank_low": rank_low,
            "rank_high": rank_high,
            "score": scores.scores,
            "score_low": low,
            "score_high": high,
            "probability_best": self.resampled.probability_best(),
            "probability_top": self.resampled.probability_in_top(self.top_k),
            "p_value": self.comparisons.p_value,
            "success_rate": table.success_rate,
            "repeats": table.tried,
        }
        means = dict(zip(table.criterion_names, scores.means.T, strict=True))
        if taken := sorted(figures.keys() & means.keys()):
            raise ScoreError(
                f"criterion {taken[0]!r} has the same name as a column of the ranking; rename the "
                "criterion"
            )
        frame = pl.DataFrame({**figures, **means}, nan_to_null=True).with_columns(
            pl.col("rank", "rank_low", "rank_high").cast(pl.Int64)
        )
        return frame.select(pl.all().gather(scores.order.tolist()))

    def weights(self) -> pl.DataFrame:
        """Weights of the criteria: ``criterion``, one column per method, their ``aggregate``."""
        import polars as pl

        scores = self.scores
        return pl.DataFrame(
            {
                "criterion": scores.table.criterion_names,
                **dict(zip(scores.settings.weights, scores.by_method, strict=True)),
                "aggregate": scores.weights,
            }
        )

    def unscored(self) -> list[str]:
        """Alternatives without a score, because a criterion has no value."""
        scores = self.scores
        lacking = np.flatnonzero(np.isnan(scores.scores))
        return [scores.table.alternatives[position] for position in lacking]

    @property
    def against(self) -> str:
        """The alternative that the others are tested against: the best, or the chosen one."""
        return self.scores.table.alternatives[self.comparisons.one]

    def indistinguishable(self, level: float = LEVEL) -> list[str]:
        """Alternatives not significantly different from `against`, sorted by score."""
        return self._named(self.comparisons.indistinguishable(level))

    def surpassed(self, level: float = LEVEL) -> list[str]:
        """Alternatives significantly worse than `against`, sorted by score."""
        return self._named(self.comparisons.surpassed(level))

    def surpassing(self, level: float = LEVEL) -> list[str]:
        """Alternatives significantly better than `against`, sorted by score."""
        return self._named(self.comparisons.surpassing(level))

    def untested(self) -> list[str]:
        """Alternatives with a score, but too few repeats in common with `against` for a test."""
        return self._named(self.comparisons.untested())

    def _named(self, positions: NDArray[np.int64]) -> list[str]:
        kept = set(positions.tolist())
        names = self.scores.table.alternatives
        return [names[position] for position in self.scores.order if int(position) in kept]

    def settings(self) -> dict[str, Any]:
        """All settings, and the numbers of repeats and resamples."""
        return {
            **asdict(self.scores.settings),
            "criteria": list(self.scores.table.criterion_names),
            "repeats": len(self.scores.table.repeats),
            "resamples": len(self.resampled.scores),
            "resampled": self.resampled.unit,
            "seed": self.seed,
            "interval": self.interval,
            "top_k": self.top_k,
            "test": self.comparisons.test,
            "against": self.against,
        }


def rank_alternatives(
    table: DecisionTable,
    settings: ScoreSettings | None = None,
    *,
    resamples: int = RESAMPLES,
    seed: int = 0,
    interval: Interval = "joint",
    test: str = "bootstrap",
    top_k: int = TOP_K,
    noun: str = "alternative",
    against: str | None = None,
) -> Ranking:
    """Score a table and estimate the uncertainty of the ranking.

    Parameters
    ----------
    table : DecisionTable
    settings : ScoreSettings, optional
    resamples : int
        Number of bootstrap resamples of the repeats, jointly for all alternatives.
    seed : int
    interval : {"joint", "pairwise"}
        Score interval: joint resampling, or pairwise as in the thesis.
    test : {"bootstrap", "wilcoxon"}
        Significance test; see `significance.compare_with_one`.
    top_k : int
        Number of first places that ``probability_top`` counts.
    noun : str
        What the alternatives are.
    against : str, optional
        The alternative that the others are tested against; the best by default.

    Raises
    ------
    AerocuesError
        If the table cannot be scored or an argument makes no sense.
    """
    check_whole("top_k", top_k, 1)
    check_choice("interval", interval, INTERVALS)
    scores = score(table, settings)
    resampled = bootstrap(scores, resamples, seed)
    comparisons = compare_with_one(scores, resampled, test, against)
    return Ranking(scores, resampled, comparisons, seed, interval, top_k, noun)
