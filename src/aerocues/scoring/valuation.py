"""Scores of tables under an objective, with fixed bounds and weights.

Bounds and weights come from the expected table. Tables drawn around it are scored with the same
ones: bounds and weights of each drawn table would only add noise.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from aerocues.scoring.aggregation import aggregate
from aerocues.scoring.criteria import LINKS, Criterion
from aerocues.scoring.links import Links
from aerocues.scoring.objectives import TIME, Objective
from aerocues.scoring.settings import ScoreSettings
from aerocues.scoring.weights import weights_by_method

Array = NDArray[np.float64]


class Valuation:
    """Scores of alternatives under an objective.

    Parameters
    ----------
    expected : (A, P, C) float64
        Known or expected values, which determine bounds and weights.
    criteria : sequence of Criterion
    blocks : (P,) int64
    settings : ScoreSettings
    objective : Objective
    weights : (C,) float64, optional
        In place of those that the expected values give.
    classes : (P,) int64, optional
        Class of each pair, for the links; all of one by default.
    """

    def __init__(
        self,
        expected: Array,
        criteria: Sequence[Criterion],
        blocks: NDArray[np.int64],
        settings: ScoreSettings,
        objective: Objective,
        weights: Array | None = None,
        classes: NDArray[np.int64] | None = None,
    ) -> None:
        self._objective = objective
        self._alpha = settings.alpha
        self._is_cost = np.array([each.better == "lower" for each in criteria])
        names = [each.name for each in criteria]
        self._time = names.index(TIME) if objective.time_power else None
        self._links = names.index(LINKS) if LINKS in names else None
        self._classes = np.zeros(expected.shape[1], np.int64) if classes is None else classes
        low, high = expected.min(axis=(0, 1)), expected.max(axis=(0, 1))
        if settings.bounds == "zero":
            low = np.zeros_like(low)
        self._low = low
        self._width = np.where(high > self._low, high - self._low, 1.0)
        self._member = _membership(blocks)
        if weights is None:
            weights = self._estimated(expected, criteria, settings)
        self.weights = weights

    def _estimated(
        self, expected: Array, criteria: Sequence[Criterion], settings: ScoreSettings
    ) -> Array:
        """(C,) weights; none for what scores are multiplied by."""
        counted = np.ones(len(criteria), np.bool_)
        counted[[place for place in (self._time, self._links) if place is not None]] = False
        matrix = self._normalised(expected.mean(axis=1))[:, counted]
        by_method = weights_by_method(matrix[None], settings.weights)
        estimated = np.zeros(len(criteria))
        estimated[counted] = aggregate(by_method, settings.aggregation)[0]
        if not estimated.any():  # all alternatives are alike
            estimated[counted] = 1.0 / counted.sum()
        return self._objective.weights(estimated, criteria)

    def _normalised(self, values: Array) -> Array:
        share = (values - self._low) / self._width
        upright = np.where(self._is_cost, 1.0 - share, share)
        powered: Array = np.clip(upright, 0.0, 1.0) ** self._alpha
        return powered

    def of(self, values: Array, counts: Array | None = None) -> Array:
        """(A,) scores of (A, P, C) values; (P,) `counts` tell how often each pair was drawn."""
        if counts is None:
            mean, member = values.mean(axis=1), self._member
            counts = np.ones(values.shape[1])
        else:
            mean = np.tensordot(values, counts / counts.sum(), axes=(1, 0))
            member = _of_drawn(self._member, counts)
        if self._objective.share < 1.0:
            by_block = np.matmul(member, values)
            scores = self._objective.over_blocks(self._normalised(by_block) @ self.weights)
        else:
            scores = self._normalised(mean) @ self.weights
        if self._links is not None:
            links = Links(values[..., self._links], self._classes)
            scores = scores * links.factor(counts[None])[0]
        if self._time is not None:
            scores = scores * self._objective.hurry(mean[:, self._time])
        return np.asarray(scores)


def _membership(blocks: NDArray[np.int64]) -> Array:
    """(B, P) weight of a pair in the mean of a block; with one block, each pair is a block."""
    names = np.unique(blocks)
    if len(names) == 1:
        return np.eye(len(blocks))
    member = (blocks[None] == names[:, None]).astype(np.float64)
    return np.asarray(member / member.sum(axis=1, keepdims=True))


def _of_drawn(member: Array, counts: Array) -> Array:
    """(B, P) weights of the drawn pairs in the means of those blocks that were drawn."""
    drawn = member * counts
    total = drawn.sum(axis=1, keepdims=True)
    there = total[:, 0] > 0
    return np.asarray(drawn[there] / total[there])


def chances(drawn: Array) -> Array:
    """(A,) share of the drawn tables, (draws, A) scores, in which an alternative is the best."""
    best = np.argmax(drawn, axis=1)
    return np.asarray(np.bincount(best, minlength=drawn.shape[1]) / len(drawn))


def interest_of(drawn: Array, few: int) -> Array:
    """(A,) share of tables in which it is the best, plus that in which it is among the few best."""
    top = np.argsort(-drawn, axis=1, kind="stable")[:, :few]
    among = np.bincount(top.ravel(), minlength=drawn.shape[1]) / len(drawn)
    return np.asarray(chances(drawn) + among)
