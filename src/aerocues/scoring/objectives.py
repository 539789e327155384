"""Objectives for choosing a combination: one row each, with a definition."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from aerocues.errors import ScoreError
from aerocues.scoring.criteria import LINKS, Aspect, Criterion
from aerocues.scoring.settings import ScorePreset, score_preset_named

Array = NDArray[np.float64]
TIME = "total_seconds"


@dataclass(frozen=True)
class Objective:
    """A purpose, and the score that it maximises.

    Attributes
    ----------
    name, title : str
    definition : str
        How the score comes about, in words.
    preset : str
        The scoring preset whose criteria, bounds and links it takes, where right matches are
        known by references of the pairs.
    shares : mapping of aspect to float
        Total weight of the criteria of each aspect; within an aspect, it is divided in proportion
        to the estimated weights. Empty: all weights as estimated.
    time_power : float
        The score is multiplied by (least seconds / seconds) to this power.
    share : float
        Share of the blocks (scenes or sequences; pairs if there is one block) over which the score
        is averaged: those with an alternative's lowest scores. 1: all pairs.
    highest : bool
        Whether it is averaged over the blocks with the highest scores.
    """

    name: str
    title: str
    definition: str
    preset: str = "default"
    shares: Mapping[Aspect, float] = field(default_factory=dict)
    time_power: float = 0.0
    share: float = 1.0
    highest: bool = False

    def scoring(self, *, references: bool, chance_test: bool = True) -> ScorePreset:
        """The preset that measurements are scored by.

        Parameters
        ----------
        references : bool
            Whether pairs have references.
        chance_test : bool
            Whether inliers beyond chance were measured.
        """
        fallback = "inliers" if chance_test else "thesis"
        return score_preset_named(self.preset if references else fallback)

    def criteria(self, scoring: ScorePreset) -> tuple[str, ...]:
        """Names of the criteria that are needed: with the links and the time where they count."""
        links = (LINKS,) if scoring.links else ()
        hurry = (TIME,) if self.time_power and TIME not in scoring.criteria else ()
        return (*scoring.criteria, *links, *hurry)

    def weights(self, estimated: Array, criteria: Sequence[Criterion]) -> Array:
        """(C,) weights of the criteria, from those that were estimated.

        What scores are multiplied by, links and time, has weight only where it is a criterion.
        """
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
        count = max(math.ceil(self.share * scores.shape[1]), 1)
        ordered = np.sort(scores, axis=1)
        chosen = ordered[:, -count:] if self.highest else ordered[:, :count]
        return np.asarray(chosen.mean(axis=1))


OBJECTIVES: dict[str, Objective] = {
    objective.name: objective
    for objective in (
        Objective(
            "balanced",
            "good 3D models, in reasonable time",
            "as reconstruction, times (least seconds / seconds) to the power 0.1: to take 10 times "
            "as long, it must be a quarter better",
            preset="models",
            time_power=0.1,
        ),
        Objective(
            "efficiency",
            "quality and speed by CUES",
            "CUES as 'aerocues score' gives it, with weights estimated from the measurements "
            "(the thesis: maximum efficiency)",
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
            "right matches first",
            "CUES with 80 % of the weight on shares (of right matches, repeatability, sharpness), "
            "20 % on counts, none on time (the thesis: accuracy first)",
            shares={"accuracy": 0.8, "quantity": 0.2},
        ),
        Objective(
            "reconstruction",
            "the best 3D models",
            "links by class of pairs, turned or not, times sqrt(right matches) x the share of them "
            "that are right within 1 px: like the quality of models, points and accuracy",
            preset="models",
        ),
        Objective(
            "robust",
            "unknown conditions",
            "CUES on a combination's worst quarter of the scenes (of the pairs, if there is one "
            "scene; in the thesis: unknown conditions)",
            share=0.25,
        ),
        Objective(
            "controlled",
            "controlled conditions",
            "CUES on a combination's best quarter of the scenes (of the pairs, if there is one "
            "scene; in the thesis: controlled conditions)",
            share=0.25,
            highest=True,
        ),
    )
}
