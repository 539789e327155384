"""Pair matchers: what they return, checked."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aerocues.methods.arrays import Float32Array


@dataclass(frozen=True, eq=False)
class PointMatches:
    """Positions that belong together.

    Parameters
    ----------
    points_1, points_2 : (N, 2) float32
        Pixels of the first and of the second image; the centre of the top-left pixel is (0, 0).
    scores : (N,) float32
        The larger, the surer; all zero where nothing is known.
    """

    points_1: Float32Array
    points_2: Float32Array
    scores: Float32Array

    def __len__(self) -> int:
        return len(self.points_1)

    def take(self, which: NDArray[np.bool_] | NDArray[np.integer[Any]]) -> PointMatches:
        """Those of a mask or of indices."""
        return PointMatches(self.points_1[which], self.points_2[which], self.scores[which])


class ArrayPairMatcher:
    """A pair matcher whose ``call`` is timed apart from the check of its result."""

    def __init__(self, native: Any) -> None:
        self._native = native

    def call(self, image_1: NDArray[np.uint8], image_2: NDArray[np.uint8]) -> Any:
        return self._native.match_pair(image_1, image_2)

    def read(self, raw: Any) -> PointMatches:
        """The finite ones among the positions; TypeError or ValueError where they are none."""
        if not isinstance(raw, tuple | list) or len(raw) not in (2, 3):
            raise TypeError(
                "a pair matcher returns two arrays of positions, or these and their scores, not "
                f"{type(raw).__name__}"
            )
        first, second = (np.ascontiguousarray(points, np.float32) for points in raw[:2])
        if first.ndim != 2 or first.shape[1] != 2 or second.shape != first.shape:
            raise ValueError(
                "a pair matcher returned positions of the shapes "
                f"{first.shape} and {second.shape}; both must be (N, 2)"
            )
        scores = np.asarray(raw[2] if len(raw) == 3 else np.zeros(len(first)), np.float32)
        if scores.shape != (len(first),):
            raise ValueError(
                f"a pair matcher returned scores of shape {scores.shape} for {len(first)} matches"
            )
        found = PointMatches(first, second, scores)
        finite = np.isfinite(np.column_stack([first, second, scores])).all(axis=1)
        return found.take(np.asarray(finite))
