"""Tests whether an alternative, the best or a chosen one, differs from the others."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from difflib import get_close_matches

import numpy as np
from numpy.typing import NDArray

from aerocues.arguments import check_choice
from aerocues.errors import ArgumentError
from aerocues.scoring.bootstrap import Bootstrap
from aerocues.scoring.cues import DIGITS, Scores
from aerocues.scoring.per_repeat import scores_of_units

Array = NDArray[np.float64]
Positions = NDArray[np.int64]
LEVEL = 0.05
# With fewer common repeats, no test has enough power.
FEWEST_UNITS = 5


@dataclass(frozen=True)
class Comparisons:
    """One alternative against all others.

    Attributes
    ----------
    one : int
        Its index.
    difference : (alternatives,) float64
        Its score minus the score of each.
    p_value : (alternatives,) float64
        Two-sided, corrected for the number of comparisons (Holm); NaN for itself, for alternatives
        without a score, and for those with too few repeats in common with it.
    test : str
    """

    one: int
    difference: Array
    p_value: Array
    test: str

    def indistinguishable(self, level: float = LEVEL) -> NDArray[np.int64]:
        """Indices of the alternatives not significantly different from it, without it."""
        return np.flatnonzero(self.p_value >= level)

    def surpassed(self, level: float = LEVEL) -> NDArray[np.int64]:
        """Indices of the alternatives that are significantly worse."""
        return np.flatnonzero((self.p_value < level) & (self.difference > 0))

    def surpassing(self, level: float = LEVEL) -> NDArray[np.int64]:
        """Indices of the alternatives that are significantly better; none than the best."""
        return np.flatnonzero((self.p_value < level) & (self.difference < 0))

    def untested(self) -> NDArray[np.int64]:
        """Indices of the alternatives with a score but too few repeats in common with it."""
        missing = np.isnan(self.p_value) & ~np.isnan(self.difference)
        missing[self.one] = False
        return np.flatnonzero(missing)


def paired_error(
    scores: Scores, resampled: Bootstrap, first: Positions, second: Positions
) -> tuple[NDArray[np.int64], Array]:
    """Units that both alternatives of each pair have, and the standard error of their difference.

    Bounds and weights are fixed: they scale all differences alike and do not affect which
    alternative is better.

    Returns
    -------
    shared : (pairs,) int64
    error : (pairs,) float64
        NaN with fewer than `FEWEST_UNITS` units in common.
    """
    known = ~np.isnan(scores_of_units(scores))
    shared = (known[first] & known[second]).sum(axis=1)
    paired = resampled.on_one_scale[:, first] - resampled.on_one_scale[:, second]
    testable = (shared >= FEWEST_UNITS) & ~np.isnan(paired).all(axis=0)
    error = np.full(len(shared), np.nan)
    # The bootstrap's variance of a mean of n is too small by (n - 1) / n.
    error[testable] = np.nanstd(paired[:, testable], axis=0) * np.sqrt(
        shared[testable] / (shared[testable] - 1)
    )
    return shared, error


def _by_resampling(
    scores: Scores, resampled: Bootstrap, first: Positions, second: Positions
) -> Array:
    """Difference of the scores over its standard error among the resamples, Student's t.

    A percentile of 1000 resamples cannot be below 0.001, too coarse for a correction for hundreds
    of comparisons; their standard error has no such limit.
    """
    # scipy.stats.t has the same values, but takes most of a second to load.
    from scipy.special import stdtr

    # Rounded as for ranks, so that rounding errors do not break ties.
    difference = np.abs(np.round(scores.scores[first] - scores.scores[second], DIGITS))
    shared, error = paired_error(scores, resampled, first, second)
    with np.errstate(divide="ignore", invalid="ignore"):
        statistic = np.where(~np.isnan(error) & (difference == 0), 0, difference / error)
    return np.asarray(2 * stdtr(np.maximum(shared - 1, 1), -statistic))


def _by_signed_ranks(scores: Scores, _: Bootstrap, first: Positions, second: Positions) -> Array:
    """Wilcoxon's signed-rank test on the scores of single units (blocks or repeats).

    If the alternative with the lower score is better unit by unit, the p-value is 1.
    """
    from scipy.stats import wilcoxon

    values = scores_of_units(scores)
    p_values = np.full(len(first), np.nan)
    for position, (one, other) in enumerate(zip(first, second, strict=True)):
        difference = scores.scores[one] - scores.scores[other]
        paired = (values[one] - values[other])[~np.isnan(values[one] + values[other])]
        if np.isnan(difference) or len(paired) < FEWEST_UNITS:
            continue
        if difference < 0:
            paired = -paired
        in_favour = bool(np.any(paired)) and wilcoxon(paired, alternative="greater").pvalue < 0.5
        p_values[position] = wilcoxon(paired).pvalue if in_favour else 1.0
    return p_values


TESTS: dict[str, Callable[[Scores, Bootstrap, Positions, Positions], Array]] = {
    "bootstrap": _by_resampling,
    "wilcoxon": _by_signed_ranks,
}
"""Two-sided p-values of the pairs of alternatives (first, second), not corrected."""


def holm(p_values: Array) -> Array:
    """Correct p-values for their number (Holm 1979); NaN values are not counted and stay NaN.

    Parameters
    ----------
    p_values : (comparisons,) float64

    Returns
    -------
    (comparisons,) float64
        At most 1.
    """
    known = np.flatnonzero(~np.isnan(p_values))
    order = known[np.argsort(p_values[known], kind="stable")]
    corrected = np.full(len(p_values), np.nan)
    steps = p_values[order] * np.arange(len(order), 0, -1)
    corrected[order] = np.minimum(np.maximum.accumulate(steps), 1)
    return corrected


def compare_with_one(
    scores: Scores, resampled: Bootstrap, test: str = "bootstrap", against: str | None = None
) -> Comparisons:
    """Test one alternative against each other alternative, paired by repeats.

    Parameters
    ----------
    scores : Scores
    resampled : Bootstrap
        Resamples of these scores.
    test : {"bootstrap", "wilcoxon"}
        Test on the difference of the scores, or on the differences in single units.
    against : str, optional
        Name of the alternative; the best by default.

    Raises
    ------
    AerocuesError
        If there is no such test or alternative, or it has no score.

    Notes
    -----
    The best is chosen on the same repeats. The truly best alternative differs significantly from it
    no more often than the level; but among many equal alternatives, the luckiest may differ
    significantly from the unluckiest. With only two alternatives and several criteria, the weights
    follow the differences, so that small p-values are too frequent.
    """
    check_choice("test", test, TESTS)
    one = scores.best if against is None else _position(scores, against)
    others = np.arange(len(scores.scores))
    p_values = TESTS[test](scores, resampled, np.full_like(others, one), others)
    p_values[one] = np.nan
    return Comparisons(one, scores.scores[one] - scores.scores, holm(p_values), test)


def _position(scores: Scores, name: str) -> int:
    """Of the alternative of this name, in any case."""
    names = scores.table.alternatives
    scored = [names[position] for position in scores.order]
    written = {each.casefold(): each for each in scored}
    found = name if name in scored else written.get(name.casefold())
    if found is None:
        close = get_close_matches(name.casefold(), written)
        hint = f"; did you mean {', '.join(written[each] for each in close)}?" if close else ""
        raise ArgumentError(f"`against` must be one of those that have a score, got {name!r}{hint}")
    return list(names).index(found)
