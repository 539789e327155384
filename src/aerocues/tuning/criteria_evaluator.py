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
    """The methods of each alternative, by kind: detector, descriptor, norm, matcher."""
    blocks: NDArray[np.int64]
    """(P,) scene or sequence of each pair."""
    classes: NDArray[np.int64]
    """(P,) class of each pair, turned or not, for the links."""
    criteria: Sequence[Criterion]
    predicted_seconds: Array
    """(A,) rough cost of each alternative on a pair."""

    @property
    def spent(self) -> float:
        """Seconds spent so far, including those reserved for the end."""
        ...

    def measure(self, cells: Sequence[Cell], keep: float = 0.0) -> Mapping[Cell, Array]:
        """(C,) values of each cell, NaN if it failed; cells for which time was up are missing.

        `keep` wall seconds are reserved for the end of the race.
        """
