"""What a race needs of an evaluator: of images, or of measurements made before."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from aerocues.scoring.criteria import Criterion
from aerocues.tuning.scales import Array

Cell = tuple[int, int]
"""Number of an alternative, and of the pair that it is evaluated on."""


class CriteriaEvaluator(Protocol):
    """Gives the criterion values of alternatives on pairs, and what that costs."""

    alternatives: Sequence[str]
    components: Mapping[str, Sequence[str]]
    """The methods of each alternative, by what they are: detector, descriptor, matcher."""
    blocks: NDArray[np.int64]
    """(P,) scene or sequence of each pair."""
    criteria: Sequence[Criterion]
    predicted_seconds: Array
    """(A,) roughly what an alternative costs on a pair."""

    @property
    def spent(self) -> float:
        """Seconds that all measurements so far took, with those that were to be kept."""
        ...

    def measure(self, cells: Sequence[Cell], keep: float = 0.0) -> Mapping[Cell, Array]:
        """Values (C,) of alternatives on pairs, NaN where one failed; none if time was up.

        `keep` are wall seconds that the end of the race will take.
        """
