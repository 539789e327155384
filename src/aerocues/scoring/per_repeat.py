"""Scores of single repeats, and the interval of the thesis."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from aerocues.defaults import RESAMPLES
from aerocues.scoring.bootstrap import CONFIDENCE
from aerocues.scoring.cues import Scores
from aerocues.scoring.normalisation import Sums, normalise
from aerocues.scoring.resampling import independent_units

Array = NDArray[np.float64]
BATCH = 64


def scores_of_repeats(scores: Scores) -> Array:
    """Score every repeat separately, with the bounds and weights of the whole table.

    Returns
    -------
    (alternatives, repeats) float64
        NaN if an alternative was not measured, or failed and failures are left out. Because of the
        power alpha, the mean of a row is not the score of the alternative.
    """
    table, settings = scores.table, scores.settings
    sums, number = Sums(table), len(table.repeats)
    whole = sums.means(np.ones((1, number)))
    columns = []
    for start in range(0, number, BATCH):
        single = np.eye(number)[start : start + BATCH]
        means = sums.means(single, like=whole)
        normalised = normalise(means, table, settings) ** settings.alpha
        columns.append((normalised @ scores.weights * means.links).T)
    return np.concatenate(columns, axis=1)


def scores_of_units(scores: Scores) -> Array:
    """Mean of the scores of repeats within each independent unit (block or repeat).

    Returns
    -------
    (alternatives, units) float64
        NaN if an alternative has no scored repeat in a unit.
    """
    values = scores_of_repeats(scores)
    units = independent_units(scores.table)
    known = ~np.isnan(values)
    member = np.eye(int(units.max()) + 1)[units]
    total, count = np.where(known, values, 0) @ member, known @ member
    mean = np.full(total.shape, np.nan)
    np.divide(total, count, out=mean, where=count > 0)
    return mean


def interval_of_repeats(
    scores: Scores, resamples: int = RESAMPLES, seed: int = 0, confidence: float = CONFIDENCE
) -> tuple[Array, Array]:
    """The interval of the thesis: bootstrap of the mean score of single repeats.

    Repeats are drawn separately for each alternative, with fixed bounds and weights. Therefore two
    intervals say little about the difference of two alternatives.

    Returns
    -------
    low, high : (alternatives,) float64
    """
    tail = (1 - confidence) / 2
    values = scores_of_repeats(scores)
    result = np.full((2, len(values)), np.nan)
    for position, row in enumerate(values):
        known = row[~np.isnan(row)]
        if not len(known):
            continue
        # One generator per alternative: its interval does not depend on the other alternatives.
        generator = np.random.default_rng(seed)
        drawn = generator.integers(len(known), size=(resamples, len(known)))
        result[:, position] = np.quantile(known[drawn].mean(axis=1), [tail, 1 - tail])
    return result[0], result[1]
