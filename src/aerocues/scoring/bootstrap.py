"""Uncertainty of the scores, by resampling the repeats."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from aerocues.arguments import check_whole
from aerocues.defaults import RESAMPLES
from aerocues.scoring.cues import Scores, rank, score_batch
from aerocues.scoring.normalisation import Sums, normalise
from aerocues.scoring.resampling import Unit, draws, independent_units, unit_of_resampling

Array = NDArray[np.float64]
BATCH_ELEMENTS = 2_000_000
CONFIDENCE = 0.95


@dataclass(frozen=True)
class Bootstrap:
    """Scores of resamples.

    Attributes
    ----------
    centre : (alternatives,) float64
        Scores of the original table.
    scores, ranks : (resamples, alternatives) float64
        NaN where an alternative has no valid repeat in a resample.
    on_one_scale : (resamples, alternatives) float64
        Scores with the bounds and weights of the original table: only the variation of the repeats,
        without that of the scale.
    weights : (resamples, criteria) float64
    unit : {"block", "repeat"}
        What is resampled.
    units : int
        Number of units. With a single unit, intervals and probabilities are NaN.
    units_of : (alternatives,) int64
        Units in which each alternative was measured: a race leaves most of them out early.
    """

    centre: Array
    scores: Array
    ranks: Array
    on_one_scale: Array
    weights: Array
    unit: Unit
    units: int
    units_of: NDArray[np.int64]

    def score_interval(self, confidence: float = CONFIDENCE) -> tuple[Array, Array]:
        """Lower and upper bound, (alternatives,) each: Student's t interval of the score.

        Percentiles of resamples of few repeats are too narrow, and cannot reach beyond the repeats.
        The scale is estimated from the same repeats, which takes a degree of freedom and shifts
        the score; the mean shift of the resamples widens the interval (`benchmarks/intervals.py`).
        """
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)  # alternatives without a score
            error = np.nanstd(self.scores, axis=0)
            shift = np.abs(np.nanmean(self.scores, axis=0) - self.centre)
        reach = self._quantile(confidence, estimated=2) * error + shift
        return np.maximum(self.centre - reach, 0.0), np.minimum(self.centre + reach, 1.0)

    def rank_interval(self, confidence: float = CONFIDENCE) -> tuple[Array, Array]:
        """Best and worst rank, (alternatives,) each: expanded percentile interval of the rank.

        Percentiles are taken as far out as Student's t interval of a mean reaches (T. Hesterberg,
        "What teachers should know about the bootstrap", 2015).
        """
        from scipy.special import ndtr

        low, high = _interval(self.ranks, ndtr(-self._quantile(confidence)))
        return np.floor(low), np.ceil(high)

    def _quantile(self, confidence: float, estimated: int = 1) -> Array:
        """(alternatives,) quantiles of Student's t, for the standard deviation of resamples.

        Their variance is that of a mean of the units n, times (n - 1) / n. NaN for a single unit.
        """
        # scipy.stats.t has the same values, but takes most of a second to load.
        from scipy.special import stdtrit

        units = np.maximum(self.units_of, 2)
        free = np.maximum(units - estimated, 1)
        quantiles = stdtrit(free, (1 + confidence) / 2) * np.sqrt(units / (units - 1))
        return np.where(self.units_of > 1, quantiles, np.nan)

    def probability_best(self) -> Array:
        """(alternatives,) share of the resamples in which each is the best; ties share it."""
        first = self.ranks == 1
        share = first / np.maximum(first.sum(axis=1, keepdims=True), 1)
        return self._where_known(share.mean(axis=0))

    def probability_in_top(self, places: int) -> Array:
        """(alternatives,) share of the resamples in which each ranks among the first `places`."""
        return self._where_known((self.ranks <= places).mean(axis=0))

    def _where_known(self, values: Array) -> Array:
        return np.where(self.units > 1, values, np.nan)


def bootstrap(scores: Scores, resamples: int = RESAMPLES, seed: int = 0) -> Bootstrap:
    """Score resamples of the repeats.

    Repeats, or whole blocks of them, are drawn with replacement, jointly for all alternatives.
    Bounds, means and weights are estimated anew in each resample.

    Parameters
    ----------
    scores : Scores
        Scores of the original table.
    resamples : int
        At least 2.
    seed : int
        At least 0.

    Raises
    ------
    ArgumentError
        If there are fewer than 2 resamples or the seed is negative.
    """
    check_whole("resamples", resamples, 2)
    check_whole("seed", seed, 0)
    table, sums = scores.table, Sums(scores.table)
    whole = sums.means(np.ones((1, len(table.repeats))))
    size = max(len(table.alternatives), len(table.repeats)) * len(table.criteria)
    found, on_one_scale = [], []
    for counts in draws(table, resamples, seed, max(1, BATCH_ELEMENTS // size)):
        means = sums.means(counts)
        found.append(score_batch(means, table, scores.settings))
        means = replace(means, low=whole.low, high=whole.high, least_positive=whole.least_positive)
        normalised = normalise(means, table, scores.settings) ** scores.settings.alpha
        on_one_scale.append(normalised @ scores.weights * means.links)
    values = np.concatenate([batch.scores for batch in found])
    # Alternatives without a score in the table are excluded.
    values[:, np.isnan(scores.scores)] = np.nan
    return Bootstrap(
        centre=scores.scores,
        scores=values,
        ranks=rank(values),
        on_one_scale=np.concatenate(on_one_scale),
        weights=np.concatenate([batch.weights for batch in found]),
        unit=unit_of_resampling(table),
        units=len(np.unique(independent_units(table))),
        units_of=_units_of(scores),
    )


def _units_of(scores: Scores) -> NDArray[np.int64]:
    """(alternatives,) number of units whose repeats count for each."""
    table = scores.table
    known = (~np.isnan(table.values)).any(axis=2)
    counts = table.tried_on if scores.settings.failures == "worst" else table.tried_on & known
    units = independent_units(table)
    return np.array([len(np.unique(units[of_one])) for of_one in counts], np.int64)


def _interval(values: Array, tails: Array) -> tuple[Array, Array]:
    """Lower and upper quantiles of columns, each with its own tail; NaN where that is NaN."""
    result = np.full((2, values.shape[1]), np.nan)
    never = np.isnan(values).all(axis=0)
    for tail in np.unique(tails[~np.isnan(tails)]):
        here = (tails == tail) & ~never
        result[:, here] = np.nanquantile(values[:, here], [tail, 1 - tail], axis=0)
    return result[0], result[1]
