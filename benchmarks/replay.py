"""Measurements that were made before, as an evaluator: for tests and benchmarks of the race."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from aerocues.scoring.criteria import Criterion
from aerocues.tuning.criteria_evaluator import Cell
from aerocues.tuning.scales import Array


class ReplayEvaluator:
    """A `CriteriaEvaluator` that gives stored values and counts what they would have cost.

    What a detector does to an image, and a descriptor to its keypoints, is paid once a pair, as
    runs do it once; the rest of an alternative's time is its own.

    Parameters
    ----------
    alternatives : sequence of str
    components : mapping of str to sequence of str
        With ``detector`` and ``descriptor`` among them.
    criteria : sequence of Criterion
    values : (A, P, C) float64
        NaN where a measurement failed.
    blocks : (P,) int64
    seconds : (A, P) float64
        Of an alternative on a pair, with the shares that others would have paid for it.
    predicted_seconds : (A,) float64
    """

    def __init__(
        self,
        alternatives: Sequence[str],
        components: Mapping[str, Sequence[str]],
        criteria: Sequence[Criterion],
        values: Array,
        blocks: NDArray[np.int64],
        seconds: Array,
        predicted_seconds: Array,
    ) -> None:
        self.alternatives, self.components, self.criteria = alternatives, components, criteria
        self.blocks, self.predicted_seconds = blocks, predicted_seconds
        self.classes = np.zeros(len(blocks), np.int64)
        self.spent = 0.0
        self._values = values
        detectors = components["detector"]
        self._shared = (
            list(detectors),
            [f"{a}-{b}" for a, b in zip(detectors, components["descriptor"], strict=True)],
        )
        self._parts = _parts(seconds, self._shared)
        self._paid: set[tuple[str, int]] = set()

    @property
    def total(self) -> float:
        """Seconds of measuring everything."""
        whole = float(self._parts[-1].sum())
        for groups, part in zip(self._shared, self._parts, strict=False):
            whole += sum(float(part[groups.index(name)].sum()) for name in dict.fromkeys(groups))
        return whole

    def measure(self, cells: Sequence[Cell], keep: float = 0.0) -> dict[Cell, Array]:
        for alternative, pair in cells:
            self.spent += float(self._parts[-1][alternative, pair])
            for groups, part in zip(self._shared, self._parts, strict=False):
                due = (groups[alternative], pair)
                if due not in self._paid:
                    self._paid.add(due)
                    self.spent += float(part[alternative, pair])
        return {cell: self._values[cell] for cell in cells}


def _parts(seconds: Array, shared: Sequence[Sequence[str]]) -> list[Array]:
    """Seconds of detecting, describing and the rest, each (A, P).

    Only sums are known: what the cheapest alternative with a detector (and descriptor) takes bounds
    what it shares with the others; nine tenths of that are taken for it.
    """
    parts, rest = [], seconds.copy()
    for groups in shared:
        names = np.array(groups)
        part = np.zeros_like(seconds)
        for name in np.unique(names):
            part[names == name] = 0.9 * rest[names == name].min(axis=0)
        parts.append(part)
        rest = rest - part
    return [*parts, rest]
