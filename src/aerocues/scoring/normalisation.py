"""Makes measured values comparable: bounds, means and min-max normalisation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aerocues.scoring.links import Links
from aerocues.scoring.settings import ScoreSettings
from aerocues.scoring.table import DecisionTable

Array = NDArray[np.float64]
ROUNDING = 1e-12


@dataclass(frozen=True)
class Means:
    """Means and bounds of a batch of resamples; see `Sums.means`.

    Attributes
    ----------
    mean : (batch, alternatives, criteria) float64
        Mean over the valid repeats; NaN if there is none.
    valid, failed : (batch, alternatives, criteria) float64
        Numbers of repeats.
    low, high : (batch, criteria) float64
        Smallest and largest value of all repeats of all alternatives.
    least_positive : (batch, criteria) float64
        Smallest of those values above 0; infinite if there is none.
    links : (batch, alternatives) float64
        What scores are multiplied by; 1 where the table has no links.
    """

    mean: Array
    valid: Array
    failed: Array
    low: Array
    high: Array
    least_positive: Array
    links: Array


class Sums:
    """A table arranged so that the means of many resamples are matrix products.

    Parameters
    ----------
    table : DecisionTable
    """

    def __init__(self, table: DecisionTable) -> None:
        self._shape = (len(table.alternatives), len(table.criteria))
        self._links = table.links
        by_repeat = table.values.transpose(1, 0, 2)
        missing = np.isnan(by_repeat)
        flat = (len(table.repeats), -1)
        self._values = np.where(missing, 0, by_repeat).reshape(flat)
        self._valid = (~missing).astype(np.float64).reshape(flat)
        self._failed = table.failed.transpose(1, 0, 2).astype(np.float64).reshape(flat)
        self._low = np.where(missing, np.inf, by_repeat).min(axis=1)
        self._high = np.where(missing, -np.inf, by_repeat).max(axis=1)
        self._positive = _above_zero(by_repeat).min(axis=1)

    def means(self, counts: Array, like: Means | None = None) -> Means:
        """Means of resamples.

        Parameters
        ----------
        counts : (batch, repeats) float64
            Number of times each repeat was drawn.
        like : Means, optional
            Whose bounds are taken; by default those of the drawn repeats.
        """
        shape = (len(counts), *self._shape)
        valid = (counts @ self._valid).reshape(shape)
        total = (counts @ self._values).reshape(shape)
        mean = np.divide(total, valid, out=np.full(shape, np.nan), where=valid > 0)
        low, high, positive = (
            self._bounds(counts) if like is None else (like.low, like.high, like.least_positive)
        )
        return Means(
            mean=mean,
            valid=valid,
            failed=(counts @ self._failed).reshape(shape),
            low=low,
            high=high,
            least_positive=positive,
            links=_factor(self._links, counts, self._shape[0]),
        )

    def _bounds(self, counts: Array) -> tuple[Array, Array, Array]:
        drawn = counts[:, :, None] > 0
        return (
            np.where(drawn, self._low, np.inf).min(axis=1),
            np.where(drawn, self._high, -np.inf).max(axis=1),
            np.where(drawn, self._positive, np.inf).min(axis=1),
        )


def _above_zero(values: Array) -> Array:
    """The values above 0; others, and those that are missing, are infinite."""
    return np.where(np.nan_to_num(values) > 0, values, np.inf)


def plain_means(table: DecisionTable) -> Means:
    """Means over all repeats, each counted once; as `Sums`, without rearranging the table."""
    missing = np.isnan(table.values)
    valid = np.count_nonzero(~missing, axis=1).astype(np.float64)
    total = np.where(missing, 0, table.values).sum(axis=1)
    mean = np.divide(total, valid, out=np.full(valid.shape, np.nan), where=valid > 0)
    return Means(
        mean=mean[None],
        valid=valid[None],
        failed=table.failed.sum(axis=1, dtype=np.float64)[None],
        low=np.where(missing, np.inf, table.values).min(axis=(0, 1))[None],
        high=np.where(missing, -np.inf, table.values).max(axis=(0, 1))[None],
        least_positive=_above_zero(table.values).min(axis=(0, 1))[None],
        links=_factor(table.links, np.ones((1, len(table.repeats))), len(table.alternatives)),
    )


def _factor(links: Links | None, counts: Array, alternatives: int) -> Array:
    return np.ones((len(counts), alternatives)) if links is None else links.factor(counts)


def normalise(means: Means, table: DecisionTable, settings: ScoreSettings) -> Array:
    """Bring all criteria into [0, 1], 1 being the best.

    A value equal for all alternatives and repeats is 1: none is worse than the best. A failed
    repeat counts as 0 or not at all. As normalisation is linear, the mean over valid and failed
    repeats is that over the valid ones times their share.

    Returns
    -------
    (batch, alternatives, criteria) float64
        NaN in all criteria of an alternative without a value in one of them.
    """
    low, high = means.low, means.high
    if settings.bounds == "positive":
        low = means.least_positive
    elif settings.bounds == "zero":
        low = np.zeros_like(low)
    width = (high - low)[:, None, :]
    offset = means.mean - low[:, None, :]
    known = np.isfinite(width) & (width > 0)
    z = np.divide(offset, width, out=np.zeros_like(offset), where=known)
    z = np.where(table.is_cost, 1 - z, z).clip(0, 1)
    # A power below 1 would blow up what rounding of a mean leaves of 0: 1e-16 ** 0.1 = 0.025.
    largest = np.maximum(np.abs(low), np.abs(high))[:, None, :]
    z[z * np.where(known, width, 1) < ROUNDING * np.where(known, largest, 0)] = 0
    z = np.where(known, z, 1)
    z[np.isnan(means.mean)] = np.nan
    if settings.failures == "worst":
        tried = means.valid + means.failed
        share = np.divide(means.valid, tried, out=np.zeros_like(tried), where=tried > 0)
        z = np.where(tried > 0, np.where(means.valid > 0, z * share, 0), np.nan)
    if settings.needs_first:
        z[:, np.isnan(table.values[:, 0, table.by_repeat]).any(axis=1)] = np.nan
    z[np.isnan(z).any(axis=2)] = np.nan
    return z
