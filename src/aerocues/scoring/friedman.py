"""Friedman's test and the critical difference of mean ranks, for a shortlist."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aerocues.errors import ScoreError
from aerocues.scoring.cues import Scores
from aerocues.scoring.per_repeat import scores_of_units

Array = NDArray[np.float64]
LEVEL = 0.05


@dataclass(frozen=True)
class CriticalDifference:
    """The content of a critical-difference diagram.

    Attributes
    ----------
    alternatives : tuple of str
        Sorted by mean rank, the best first.
    mean_ranks : (alternatives,) float64
    units : int
        Number of independent repeats or blocks.
    chi_square, p_value : float
        Friedman's statistic and p-value.
    f_statistic, f_p_value : float
        Iman and Davenport's, which is less conservative.
    critical_difference : float
        Nemenyi's critical difference of two mean ranks.
    groups : tuple of (int, int)
        First and last index of each maximal group without significant differences.
    """

    alternatives: tuple[str, ...]
    mean_ranks: Array
    units: int
    chi_square: float
    p_value: float
    f_statistic: float
    f_p_value: float
    critical_difference: float
    groups: tuple[tuple[int, int], ...]


def critical_difference(
    scores: Scores, shortlist: Sequence[int], level: float = LEVEL
) -> CriticalDifference:
    """Compare the mean ranks of a shortlist over the repeats (or blocks) of a table.

    Only units in which the whole shortlist was measured are used.

    Parameters
    ----------
    scores : Scores
    shortlist : sequence of int
        Indices of at least 2 alternatives.
    level : float

    Raises
    ------
    ScoreError
        If there are fewer than 2 alternatives or units.

    References
    ----------
    Demsar, "Statistical comparisons of classifiers over multiple data sets", JMLR 7 (2006).
    """
    values = scores_of_units(scores)[list(shortlist)]
    values = values[:, ~np.isnan(values).any(axis=0)]
    names = [scores.table.alternatives[position] for position in shortlist]
    return friedman(values, names, level)


def friedman(values: Array, names: Sequence[str], level: float = LEVEL) -> CriticalDifference:
    """Friedman's test on a table; higher values are better.

    Parameters
    ----------
    values : (alternatives, units) float64
    names : sequence of str
    level : float

    Raises
    ------
    ScoreError
        If there are fewer than 2 alternatives or units.
    """
    from scipy.stats import chi2, f, rankdata, studentized_range

    number, units = values.shape
    if number < 2 or units < 2:
        raise ScoreError(
            f"Friedman's test needs at least 2 alternatives and 2 repeats, got {number} and {units}"
        )
    ranks = rankdata(-values, axis=0)
    mean_ranks = ranks.mean(axis=1)
    # Correction for ties: tied ranks vary less than 1, 2, .., k.
    spread = ((ranks - (number + 1) / 2) ** 2).sum() / (units * (number - 1))
    distance = units * ((mean_ranks - (number + 1) / 2) ** 2).sum()
    chi_square = float(distance / spread) if spread > 0 else 0.0
    rest = units * (number - 1) - chi_square
    f_statistic = float((units - 1) * chi_square / rest) if rest > 1e-9 else float("inf")
    order = np.lexsort((np.array(names), mean_ranks))
    quantile = float(studentized_range.ppf(1 - level, number, np.inf)) / np.sqrt(2)
    least = quantile * float(np.sqrt(number * (number + 1) / (6 * units)))
    return CriticalDifference(
        alternatives=tuple(names[position] for position in order),
        mean_ranks=mean_ranks[order],
        units=units,
        chi_square=chi_square,
        p_value=float(chi2.sf(chi_square, number - 1)),
        f_statistic=f_statistic,
        f_p_value=float(f.sf(f_statistic, number - 1, (number - 1) * (units - 1))),
        critical_difference=least,
        groups=_groups(mean_ranks[order], least),
    )


def _groups(mean_ranks: Array, least: float) -> tuple[tuple[int, int], ...]:
    groups: list[tuple[int, int]] = []
    for first, low in enumerate(mean_ranks):
        last = int(np.flatnonzero(mean_ranks - low < least)[-1])
        if last > first and (not groups or last > groups[-1][1]):
            groups.append((first, last))
    return tuple(groups)
