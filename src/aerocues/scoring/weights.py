"""Objective weights of criteria, from the spread and the redundancy of their values.

All functions take a batch of matrices, so that weights can be estimated anew in every resample.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
SAME = 1e-9
ROUNDING = 1e-12
DEGENERATE = 1e-9


@dataclass(frozen=True)
class Spread:
    """Statistics of a batch of matrices that the methods need.

    Attributes
    ----------
    matrix : (batch, alternatives, criteria) float64
        In [0, 1], higher is better; 0 for excluded alternatives.
    count : (batch, 1) float64
        Number of included alternatives.
    covariance : (batch, criteria, criteria) float64
        Population covariance of the criteria over the alternatives.
    """

    matrix: Array
    count: Array
    covariance: Array

    @property
    def variance(self) -> Array:
        return np.asarray(np.diagonal(self.covariance, axis1=-2, axis2=-1))


def _entropy(spread: Spread) -> Array:
    total = spread.matrix.sum(axis=1, keepdims=True)
    share = spread.matrix / np.where(total > 0, total, 1)
    logarithm = np.log(share, where=share > 0, out=np.zeros_like(share))
    entropy = -np.einsum("bac,bac->bc", share, logarithm)
    most = np.log(np.maximum(spread.count, 2))
    weight = np.where(total[:, 0] > 0, 1 - entropy / most, 0)
    return np.asarray(np.where(weight > ROUNDING, weight, 0))


def _variance(spread: Spread) -> Array:
    return spread.variance


def _correlation(spread: Spread) -> Array:
    """Pearson's r of each pair of criteria; 1 for a constant criterion, which has no conflicts.

    r is rounded near 1: if all criteria agree, rounding errors of 1 - r would become weights.
    """
    deviation = np.sqrt(spread.variance)
    product = deviation[:, :, None] * deviation[:, None, :]
    known = product > 0
    r = spread.covariance / np.where(known, product, 1)
    r = np.where(np.abs(r) < 1 - ROUNDING, r, np.sign(r))
    return np.where(known, r, 1)


def _critic(spread: Spread) -> Array:
    conflict = 1 - _correlation(spread)
    return np.asarray(np.sqrt(spread.variance) * conflict.sum(axis=-1))


def _critic_published(spread: Spread) -> Array:
    conflict = 1 - np.abs(_correlation(spread))
    diagonal = np.arange(conflict.shape[-1])
    conflict[:, diagonal, diagonal] = 1
    return np.asarray(np.sqrt(spread.variance) * conflict.sum(axis=-1))


def _pca(spread: Spread) -> Array:
    values, vectors = np.linalg.eigh(spread.covariance)
    loadings = np.abs(vectors)
    values = np.maximum(values, 0)
    largest = values[:, -1:]
    # For equal eigenvalues the eigenvectors are arbitrary up to a rotation, which would depend on
    # the order of the criteria. The projection onto their space is unique.
    close = np.diff(values, axis=-1) <= DEGENERATE * largest
    matters = values[:, 1:] > DEGENERATE * largest
    for one in np.flatnonzero((close & matters).any(axis=-1)):
        loadings[one] = _rotation_free(values[one], vectors[one])
    total = values.sum(axis=-1, keepdims=True)
    ratio = values / np.where(total > 0, total, 1)
    return np.asarray(np.einsum("bck,bk->bc", loadings, ratio))


def _rotation_free(values: Array, vectors: Array) -> Array:
    """Loadings (criteria, components), equal for all components of the same eigenvalue."""
    loadings = np.abs(vectors)
    starts = np.flatnonzero(np.diff(values, prepend=-1.0) > DEGENERATE * values[-1])
    for start, end in zip(starts, [*starts[1:], len(values)], strict=True):
        share = np.sqrt((vectors[:, start:end] ** 2).mean(axis=1, keepdims=True))
        loadings[:, start:end] = share
    return loadings


@dataclass(frozen=True)
class WeightMethod:
    """One method: ``compute`` returns (batch, criteria), non-negative, not normalised."""

    name: str
    description: str
    source: str
    compute: Callable[[Spread], Array]


WEIGHT_METHODS: dict[str, WeightMethod] = {
    method.name: method
    for method in (
        WeightMethod(
            "entropy",
            "1 - entropy of each alternative's share",
            "Shannon 1948; Hwang and Yoon 1981",
            _entropy,
        ),
        WeightMethod("variance", "population variance", "Rao and Patel 2010", _variance),
        WeightMethod(
            "critic",
            "standard deviation x sum of (1 - r) over the other criteria",
            "Diakoulaki, Mavrotas and Papayannakis 1995",
            _critic,
        ),
        WeightMethod(
            "critic_published",
            "standard deviation x (1 + sum of (1 - abs(r)) over the other criteria)",
            "the thesis's published figures",
            _critic_published,
        ),
        WeightMethod(
            "pca",
            "sum over principal components of explained-variance ratio x abs(loading)",
            "principal components of the covariance",
            _pca,
        ),
    )
}


def weights_by_method(matrix: Array, methods: Sequence[str]) -> Array:
    """Weights of the criteria by each method.

    Parameters
    ----------
    matrix : (batch, alternatives, criteria) float64
        In [0, 1], higher is better; NaN in all criteria of an excluded alternative.
    methods : sequence of str
        Names of rows of `WEIGHT_METHODS`.

    Returns
    -------
    (batch, methods, criteria) float64
        Each set sums to 1. A constant criterion has weight 0. If a method gives no weight to any
        criterion, all criteria that vary get equal weights; if all are constant, all do.
    """
    present = ~np.isnan(matrix)
    varies = _varies(matrix, present)
    filled = np.where(present, matrix, 0)
    count = present[:, :, 0].sum(axis=1, keepdims=True).astype(np.float64)
    mean = filled.sum(axis=1) / np.maximum(count, 1)
    centred = np.where(present, matrix - mean[:, None, :], 0)
    covariance = centred.transpose(0, 2, 1) @ centred / np.maximum(count, 1)[:, :, None]
    both = varies[:, :, None] & varies[:, None, :]
    spread = Spread(filled, count, np.where(both, covariance, 0))
    alike = np.where(varies.any(axis=-1, keepdims=True), varies, True).astype(np.float64)
    sets = []
    for name in methods:
        raw = np.where(varies, np.maximum(WEIGHT_METHODS[name].compute(spread), 0), 0)
        total = raw.sum(axis=-1, keepdims=True)
        raw = np.where(total > 0, raw, alike)
        sets.append(raw / raw.sum(axis=-1, keepdims=True))
    return np.stack(sets, axis=1)


def _varies(matrix: Array, present: Mask) -> Mask:
    low = np.where(present, matrix, np.inf).min(axis=1)
    high = np.where(present, matrix, -np.inf).max(axis=1)
    return np.asarray(high - low > SAME)
