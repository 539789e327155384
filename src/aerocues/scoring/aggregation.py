"""Ways to aggregate the weights of several methods: one row each."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
MIDDLE = 3


def _geometric(weights: Array) -> Array:
    with np.errstate(divide="ignore"):
        return np.asarray(np.exp(np.log(weights).mean(axis=-2)))


def _harmonic(weights: Array) -> Array:
    with np.errstate(divide="ignore"):
        return np.asarray(1 / (1 / weights).mean(axis=-2))


def _trimmed(weights: Array) -> Array:
    """Mean without the smallest and the largest value: of four, the mean of the middle two."""
    if weights.shape[-2] < MIDDLE:
        return np.asarray(weights.mean(axis=-2))
    return np.asarray(np.sort(weights, axis=-2)[..., 1:-1, :].mean(axis=-2))


AGGREGATIONS: dict[str, Callable[[Array], Array]] = {
    "arithmetic": lambda weights: np.asarray(weights.mean(axis=-2)),
    "geometric": _geometric,
    "harmonic": _harmonic,
    "trimmed": _trimmed,
}


def aggregate(weights: Array, name: str) -> Array:
    """One set of weights from those of several methods.

    Parameters
    ----------
    weights : (..., methods, criteria) float64
        Non-negative; each set sums to 1.
    name : str
        A row of `AGGREGATIONS`.

    Returns
    -------
    (..., criteria) float64
        The sum is 1. If no criterion has a positive weight by all methods, the geometric and
        harmonic means are undefined and the arithmetic mean is returned.
    """
    combined = AGGREGATIONS[name](weights)
    total = combined.sum(axis=-1, keepdims=True)
    return np.where(total > 0, combined / np.where(total > 0, total, 1), weights.mean(axis=-2))
