"""Predicts the measurements that were not made from those that were.

A transformed value is the sum of effects of detector, descriptor and matcher (overall and in each
block of pairs), of the combination (likewise) and of the pair: a mixed linear model, fitted by
backfitting with ridge penalties in place of variances (Hastie, Tibshirani and Friedman, "The
Elements of Statistical Learning", 2009, section 9.1).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aerocues.tuning.scales import Array, Mask

# Passes of backfitting: more fit closer and take proportionally longer, in every round of a race.
_ROUNDS = 4
# Ridge penalties: the number of measurements at which an effect is shrunk to half. Higher ones need
# more data before they trust an effect; effects in one block have fewer data, and a higher penalty.
_OF_METHODS, _OF_METHODS_IN_BLOCK = 1.0, 4.0
_OF_ALTERNATIVE, _OF_ALTERNATIVE_IN_BLOCK = 0.5, 1.0
_OF_PAIR = 1.0
# An alternative's own noise needs 3 measurements of it, and 30 of such measurements in all; with
# fewer, the residuals of all alternatives are used, which are wider.
_OFTEN, _ENOUGH = 3, 30
_NEXT_TO_NOTHING = 1e-9
_SPREAD_IN_BLOCK = 0.7
"""Spread of a combination between blocks over its whole spread: higher values keep races longer."""


@dataclass(frozen=True, eq=False)
class Surrogate:
    """The fitted model.

    Parameters
    ----------
    expected : (A, P, C) float64
        Transformed by `Scales`; including the measured cells.
    counts : (A,) int
        Measured cells of each alternative.
    counts_in_block : (A, B) int
    block_of : (P,) int
        Number of the block of each pair, from 0.
    residuals : (N, C) float64
        Residuals of the measured cells after the effects of methods and pairs.
    noise : (M, C) float64
        Residuals after the alternatives' own effects, of often measured alternatives.
    features : (A, K) float64
    groups : (K,) int64
        Kind of method of each column: detector, descriptor, matcher or a pair of methods.
    coefficients : (K, C) float64
        Effects of the methods.
    """

    expected: Array
    counts: NDArray[np.intp]
    counts_in_block: NDArray[np.intp]
    block_of: NDArray[np.intp]
    residuals: Array
    noise: Array
    features: Array
    groups: NDArray[np.int64]
    coefficients: Array

    def draw(self, rng: np.random.Generator) -> Array:
        """(A, P, C) plausible values of the cells, drawn around the expected ones.

        An alternative deviates from the prediction like the measured alternatives do, and less the
        more often it was measured; all criteria of a cell are drawn together, as they correlate.
        Effects of methods deviate likewise: that of an unmeasured method as much as methods differ.
        """
        alternatives, blocks = self.counts_in_block.shape
        own = _drawn(self.residuals, self.noise, self.counts, rng)
        own = own + self.features @ self._methods(rng)
        shift = np.repeat(own[:, None], blocks, axis=1)
        if blocks > 1:
            there = self.noise[rng.integers(len(self.noise), size=(alternatives, blocks))]
            there = there * np.sqrt(1.0 / (self.counts_in_block + 1.0))[..., None]
            shift += _SPREAD_IN_BLOCK * there
        drawn: Array = self.expected + shift[:, self.block_of]
        return drawn

    def _methods(self, rng: np.random.Generator) -> Array:
        """(K, C) deviations of the methods' effects, as wide as ridge regression estimates them."""
        counts = (self.features * self.counts[:, None]).sum(axis=0)
        noise = np.maximum(self.residuals.std(axis=0), _NEXT_TO_NOTHING)
        departures = np.zeros_like(self.coefficients)
        for group in np.unique(self.groups):
            own = self.groups == group
            seen = self.coefficients[own & (counts > 0)]
            spread = np.maximum(seen.std(axis=0), _NEXT_TO_NOTHING)
            width = 1.0 / np.sqrt(1.0 / spread**2 + counts[own, None] / noise**2)
            alike = (seen - seen.mean(axis=0)) / spread
            departures[own] = alike[rng.integers(len(alike), size=own.sum())] * width
        return departures


def fit(
    stretched: Array,
    known: Mask,
    features: Array,
    groups: NDArray[np.int64],
    blocks: NDArray[np.int64],
) -> Surrogate:
    """Fit the model to the known cells.

    Parameters
    ----------
    stretched : (A, P, C) float64
        Transformed values; only known cells are read.
    known : (A, P) bool
    features : (A, K) float64
        Indicators: 1 for each method of an alternative.
    groups : (K,) int64
        Columns of the same kind of method have the same number.
    blocks : (P,) int64
    """
    names, block_of = np.unique(blocks, return_inverse=True)
    a, p = np.nonzero(known)
    values, own, b = stretched[a, p], features[a], block_of[p]
    shape = (known.shape[0], len(names), values.shape[1])
    counts = known.sum(axis=1)
    counts_in_block = np.zeros(shape[:2], np.intp)
    np.add.at(counts_in_block, (a, b), 1)
    mean = values.mean(axis=0)
    pairs = np.zeros((known.shape[1], shape[2]))
    alternative, in_block = np.zeros((shape[0], shape[2])), np.zeros(shape)
    methods_in_block = np.zeros(shape)
    expected = np.zeros(shape)
    coefficients = np.zeros((features.shape[1], shape[2]))
    for _ in range(_ROUNDS):
        rest = values - mean - pairs[p] - alternative[a] - in_block[a, b]
        coefficients = _ridge(own, rest - methods_in_block[a, b], _OF_METHODS)
        methods = features @ coefficients
        rest = rest - methods[a]
        for block in range(shape[1]):
            of_block = b == block
            of_methods = _ridge(own[of_block], rest[of_block], _OF_METHODS_IN_BLOCK)
            methods_in_block[:, block] = features @ of_methods
        expected = mean + methods[:, None] + methods_in_block
        rest = values - expected[a, b] - pairs[p]
        alternative = _summed(rest - in_block[a, b], a, shape[0])
        alternative /= (counts + _OF_ALTERNATIVE)[:, None]
        in_block = np.zeros(shape)
        np.add.at(in_block, (a, b), rest - alternative[a])
        in_block /= (counts_in_block + _OF_ALTERNATIVE_IN_BLOCK)[..., None]
        rest = values - expected[a, b] - alternative[a] - in_block[a, b]
        pairs = _summed(rest, p, len(pairs)) / (known.sum(axis=0) + _OF_PAIR)[:, None]
    whole = (expected + alternative[:, None] + in_block)[:, block_of] + pairs
    whole[a, p] = values
    residuals = values - expected[a, b] - pairs[p]
    noise = _noise(residuals, a, counts)
    return Surrogate(
        whole, counts, counts_in_block, block_of, residuals, noise, features, groups, coefficients
    )


def _noise(residuals: Array, alternative: NDArray[np.intp], counts: NDArray[np.intp]) -> Array:
    """Residuals within often measured alternatives; all residuals if there are too few."""
    often = counts[alternative] >= _OFTEN
    if often.sum() < _ENOUGH:
        return residuals
    mean = _summed(residuals, alternative, len(counts)) / np.maximum(counts, 1)[:, None]
    number = counts[alternative][often]
    freedom = np.sqrt(number / (number - 1.0))[:, None]
    return np.asarray((residuals - mean[alternative])[often] * freedom)


def _drawn(
    residuals: Array, noise: Array, counts: NDArray[np.intp], rng: np.random.Generator
) -> Array:
    """(A, C) deviations of alternatives: drawn from noise if measured, else from all residuals."""
    unknown = residuals[rng.integers(len(residuals), size=len(counts))]
    known = noise[rng.integers(len(noise), size=len(counts))]
    known = known * np.sqrt(1.0 / np.maximum(counts, 1))[:, None]
    return np.where((counts > 0)[:, None], known, unknown)


def _ridge(features: Array, values: Array, penalty: float) -> Array:
    size = features.shape[1]
    return np.asarray(
        np.linalg.solve(features.T @ features + penalty * np.eye(size), features.T @ values)
    )


def _summed(values: Array, group: NDArray[np.intp], groups: int) -> Array:
    total = np.zeros((groups, values.shape[1]))
    np.add.at(total, group, values)
    return total
