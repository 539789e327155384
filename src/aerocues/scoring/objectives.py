"""What a choice is to serve: one row an objective, each with a definition."""

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
    """What the best combination is best for.

    Attributes
    ----------
    name, title : str
    definition : str
        How the score comes about, in words.
    shares : mapping of aspect to float
        Share of the weight of all criteria that those of an aspect get together, divided among
        them as estimated; none: all weights as estimated.
    time_power : float
        The score is multiplied by (least seconds / seconds) to this power.
    worst : float
        Share of the blocks (scenes, sequences; pairs, where there is one) over which the score is
        averaged: those where an alternative does worst. 1: all pairs alike.
    """

    name: str
    title: str
    definition: str
    shares: Mapping[Aspect, float] = field(default_factory=dict)
    time_power: float = 0.0
    worst: float = 1.0

    def criteria(self, names: Sequence[str]) -> tuple[str, ...]:
        """Names of the criteria that are needed: those given, and the time where it counts."""
        return (*names, TIME) if self.time_power and TIME not in names else tuple(names)

    def weights(self, estimated: Array, criteria: Sequence[Criterion]) -> Array:
        """(C,) weights of the criteria, from those that were estimated."""
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
                f"the objective {self.name} weighs {', '.join(self.shares)}, of which there is no "
                "criterion; choose balanced"
            )
        return np.asarray(weights / whole)

    def hurry(self, seconds: Array) -> Array:
        """(A,) factors of the scores of alternatives that take so long."""
        known = np.maximum(seconds, 1e-9)
        return np.asarray((known.min() / known) ** self.time_power)

    def over_blocks(self, scores: Array) -> Array:
        """(A,) from scores (A, B) in each block."""
        count = max(math.ceil(self.worst * scores.shape[1]), 1)
        return np.asarray(np.sort(scores, axis=1)[:, :count].mean(axis=1))


OBJECTIVES: dict[str, Objective] = {
    objective.name: objective
    for objective in (
        Objective(
            "balanced",
            "quality and speed in balance",
            "CUES as 'aerocues score' gives it, with weights estimated from the measurements "
            "(the thesis: maximum efficiency)",
        ),
        Objective(
            "speed",
            "boards and phones: good, and soon done",
            "CUES of accuracy (half the weight) and quantity (half), times the fourth root of "
            "least seconds / seconds: to take 16 times as long, it must be twice as good (the "
            "thesis: mobile)",
            shares={"accuracy": 0.5, "quantity": 0.5},
            time_power=0.25,
        ),
        Objective(
            "accuracy",
            "right matches first",
            "CUES with 80 % of the weight on shares (recall, precision, repeatability, F1), 20 % "
            "on counts, none on time (the thesis: accuracy first)",
            shares={"accuracy": 0.8, "quantity": 0.2},
        ),
        Objective(
            "reconstruction",
            "3D models with many points",
            "CUES with 60 % of the weight on counts (inliers, matches), 40 % on shares, none on "
            "time",
            shares={"accuracy": 0.4, "quantity": 0.6},
        ),
        Objective(
            "robust",
            "unknown conditions",
            "CUES on the quarter of the scenes (of the pairs, where there is one scene) where a "
            "combination does worst (the thesis: unknown conditions)",
            worst=0.25,
        ),
    )
}


def objective_named(name: str) -> Objective:
    """The objective of this name; ScoreError where there is none."""
    if name not in OBJECTIVES:
        raise ScoreError(f"there is no objective {name!r}; choose from {', '.join(OBJECTIVES)}")
    return OBJECTIVES[name]
