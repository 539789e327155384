"""Correlations between criteria, and between rankings."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from aerocues.scoring.cues import Scores

Array = NDArray[np.float64]
FEWEST = 3


def rank_correlation(rows: Array, method: Literal["spearman", "kendall"] = "spearman") -> Array:
    """Rank correlation of every two rows, over the columns where both have a value.

    Parameters
    ----------
    rows : (rankings, alternatives) float64
        Scores; NaN where an alternative has none.
    method : {"spearman", "kendall"}
        Kendall's is tau-b.

    Returns
    -------
    (rankings, rankings) float64
        NaN where fewer than 3 alternatives are in both or one ranks them all alike.
    """
    from scipy.stats import kendalltau, spearmanr

    # Rounded as for ranks: what differs by rounding only is equal.
    measures: dict[str, Callable[[Array, Array], Any]] = {
        "spearman": spearmanr,
        "kendall": kendalltau,
    }
    measure = measures[method]
    return _pairwise(np.round(rows, 12), lambda a, b: float(measure(a, b).statistic))


def criteria_correlation(scores: Scores) -> Array:
    """Pearson's correlation of the criteria's means over the alternatives.

    Returns
    -------
    (criteria, criteria) float64
        Of the values as measured, over the repeats that succeeded, costs not inverted; NaN where
        a criterion is constant.
    """
    return _pairwise(scores.means.T, _pearson)


def _pearson(a: Array, b: Array) -> float:
    # Scaled first: the products of very large or very small values are no longer numbers.
    return float(np.corrcoef(a / np.abs(a).max(), b / np.abs(b).max())[0, 1])


def _pairwise(rows: Array, measure: Callable[[Array, Array], float]) -> Array:
    result = np.full((len(rows), len(rows)), np.nan)
    for first, a in enumerate(rows):
        for second in range(first, len(rows)):
            b = rows[second]
            both = ~np.isnan(a) & ~np.isnan(b)
            varied = both.sum() >= FEWEST and np.ptp(a[both]) > 0 and np.ptp(b[both]) > 0
            if varied:
                value = 1.0 if first == second else measure(a[both], b[both])
                result[first, second] = result[second, first] = value
    return result
