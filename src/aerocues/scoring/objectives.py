"""Objectives for choosing a combination: one row each, with a definition."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from aerocues.errors import ScoreError
from aerocues.scoring.criteria import Aspect, Criterion

Array = NDArray[np.float64]
TIME = "total_seconds"


@dataclass(frozen=True)
class Objective:
    """A purpose, and the score that it maximises.

    Attributes
    ----------
    name, title : str
    definition : str
        The score in words.
    shares : mapping of aspect to float
        Total weight of the criteria of each aspect; within an aspect, it is divided in proportion
        to the estimated weights. Empty: all weights as estimated.
    time_power : float
        The score is multiplied by (least seconds / seconds) to this power.
    worst : float
        Share of the blocks (scenes or sequences; pairs if there is one block) over which the score
        is averaged: those with an alternative's lowest scores. 1: all pairs.
    """

    name: str
    title: str
    definition: str
    shares: Mapping[Aspect, float] = field(default_factory=dict)
    time_power: float = 0.0
    worst: float = 1.0

    def criteria(self, names: Sequence[str]) -> tuple[str, ...]:
        """Names of the needed criteria: the given ones, and the time if it counts."""
        return (*names, TIME) if self.time_power and TIME not in names else tuple(names)

    def weights(self, estimated: Array, criteria: Sequence[Criterion]) -> Array:
        """(C,) weights of the criteria, from the estimated weights."""
        if not self.shares:
            return estimated
        weights = np.zeros_like(estimated)
        for aspect, share in self.shares.items():
            own = np.array([criterion.aspect == aspect for criterion in criteria])
            total = estimated[own].sum()
            even = 1.0 / max(int(own.sum()), 1)
            weights[own] = share * (estimated[own] / total if total > 0 else even)
        whole = weights.sum()
        if not whole:
            raise ScoreError(
                f"the objective {self.name} needs criteria of {', '.join(self.shares)}; there are "
                "none: choose the objective balanced"
            )
        return np.asarray(weights / whole)

    def hurry(self, seconds: Array) -> Array:
        """(A,) factors that multiply the scores, from the seconds of the alternatives."""
        known = np.maximum(seconds, 1e-9)
        return np.asarray((known.min() / known) ** self.time_power)

    def over_blocks(self, scores: Array) -> Array:
        """(A,) scores from the scores (A, B) in each block."""
        count = max(math.ceil(self.worst * scores.shape[1]), 1)
        return np.asarray(np.sort(scores, axis=1)[:, :count].mean(axis=1))


OBJECTIVES: dict[str, Objective] = {
    objective.name: objective
    for objective in (
        Objective(
            "balanced",
            "a balance of quality and speed",
            "CUES as in 'aerocues score', with weights estimated from the measurements (in the "
            "thesis: maximum efficiency)",
        ),
        Objective(
            "speed",
            "boards and phones",
            "CUES of accuracy (half of the weight) and quantity (half), times the fourth root of "
            "least seconds / seconds: a combination that takes 16 times as long must be twice as "
            "good (in the thesis: mobile)",
            shares={"accuracy": 0.5, "quantity": 0.5},
            time_power=0.25,
        ),
        Objective(
            "accuracy",
            "correct matches",
            "CUES with 80 % of the weight on shares (recall, precision, repeatability, F1), 20 % "
            "on counts and none on time (in the thesis: accuracy first)",
            shares={"accuracy": 0.8, "quantity": 0.2},
        ),
        Objective(
            "reconstruction",
            "3D models with many points",
            "CUES with 60 % of the weight on counts (inliers, matches), 40 % on shares and none "
            "on time",
            shares={"accuracy": 0.4, "quantity": 0.6},
        ),
        Objective(
            "robust",
            "unknown conditions",
            "CUES on a combination's worst quarter of the scenes (of the pairs, if there is one "
            "scene; in the thesis: unknown conditions)",
            worst=0.25,
        ),
    )
}
