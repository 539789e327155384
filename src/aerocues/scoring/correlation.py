"""Correlations between criteria, between rankings, and of figures with outcomes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from aerocues.scoring.cues import Scores

if TYPE_CHECKING:
    import polars as pl

Array = NDArray[np.float64]
Measure = Callable[[Array, Array], float]
FEWEST = 3


def rank_correlation(rows: Array, method: Literal["spearman", "kendall"] = "spearman") -> Array:
    """Rank correlation of all pairs of rows, over the columns where both have a value.

    Parameters
    ----------
    rows : (rankings, alternatives) float64
        Scores; NaN where an alternative has none.
    method : {"spearman", "kendall"}
        Kendall's is tau-b.

    Returns
    -------
    (rankings, rankings) float64
        NaN if fewer than 3 alternatives are in both, or one ranking has only ties.
    """
    # Rounded as for ranks, so that rounding errors do not break ties.
    return _pairwise(np.round(rows, 12), _rank_measure(method))


def correlation_between(
    rows: Array, others: Array, method: Literal["pearson", "spearman", "kendall"] = "pearson"
) -> Array:
    """Correlation of each row with each other row, over the columns where both have a value.

    Parameters
    ----------
    rows : (rows, alternatives) float64
        NaN where there is no value.
    others : (others, alternatives) float64
    method : {"pearson", "spearman", "kendall"}

    Returns
    -------
    (rows, others) float64
        NaN if fewer than 3 alternatives have both values, or one of the rows is constant.
    """
    measure = _pearson if method == "pearson" else _rank_measure(method)
    found = [[_correlation(row, other, measure) for other in others] for row in rows]
    return np.array(found, np.float64).reshape(len(rows), len(others))


def _rank_measure(method: Literal["spearman", "kendall"]) -> Measure:
    from scipy.stats import kendalltau, spearmanr

    measures: dict[str, Callable[[Array, Array], Any]] = {
        "spearman": spearmanr,
        "kendall": kendalltau,
    }
    measure = measures[method]
    return lambda a, b: float(measure(a, b).statistic)


def criteria_correlation(scores: Scores) -> Array:
    """Pearson's correlation of the criteria's means over the alternatives.

    Returns
    -------
    (criteria, criteria) float64
        Over the successful repeats, with measured values (costs are not inverted); NaN if a
        criterion is constant.
    """
    return _pairwise(scores.means.T, _pearson)


def _pearson(a: Array, b: Array) -> float:
    # Scaled first: products of very large or very small values would overflow or underflow.
    return float(np.corrcoef(a / np.abs(a).max(), b / np.abs(b).max())[0, 1])


def _pairwise(rows: Array, measure: Measure) -> Array:
    result = np.full((len(rows), len(rows)), np.nan)
    for first, a in enumerate(rows):
        for second in range(first, len(rows)):
            value = _correlation(a, rows[second], measure)
            if first == second and not np.isnan(value):
                value = 1.0  # exactly
            result[first, second] = result[second, first] = value
    return result


def _correlation(a: Array, b: Array, measure: Measure) -> float:
    """The measure; NaN if fewer than 3 columns have both values, or one row is constant."""
    both = ~np.isnan(a) & ~np.isnan(b)
    if both.sum() < FEWEST or np.ptp(a[both]) == 0 or np.ptp(b[both]) == 0:
        return float("nan")
    return measure(a[both], b[both])


def correlation_frame(names: Sequence[str], values: NDArray[np.float64]) -> pl.DataFrame:
    """A matrix with the names of its rows in the first column; undefined values are null."""
    import polars as pl

    columns = dict(zip(names, np.asarray(values).T, strict=True))
    return pl.DataFrame({"name": list(names), **columns}, nan_to_null=True)
