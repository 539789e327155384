"""The matcher RATIO: nearest neighbours that are clearly nearer than the second nearest."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from aerocues.methods.arrays import DescriptorArray, Features, Matches

# What cv2.BFMatcher computes distances with.
_NORMS: dict[str, tuple[int, int]] = {
    "L2": (cv2.NORM_L2, cv2.CV_32F),
    "HAM": (cv2.NORM_HAMMING, cv2.CV_32S),
}


class RatioMatcher:
    """Mutual nearest neighbours that pass the ratio test in both directions.

    Parameters
    ----------
    ratio : float
        The distance must be smaller than that to the second nearest times this.
    """

    def __init__(self, ratio: float) -> None:
        self._ratio = ratio

    def match(self, features_1: Features, features_2: Features, norm: str) -> Matches:
        """The matches of BF that pass."""
        first, second = features_1.descriptors, features_2.descriptors
        forth, distance = self._nearest(first, second, norm)
        back, _ = self._nearest(second, first, norm)
        rows = np.arange(len(first))
        kept = rows[(forth >= 0) & (back[forth] == rows)]
        indices = np.column_stack([kept, forth[kept]]).astype(np.int32)
        return Matches(indices, distance[kept])

    def _nearest(
        self, first: DescriptorArray, second: DescriptorArray, norm: str
    ) -> tuple[NDArray[Any], NDArray[np.float32]]:
        """Of each descriptor the nearest one, -1 where the second is as near, and its distance."""
        kind, dtype = _NORMS[norm]
        two = min(2, len(second))
        distance, nearest = cv2.batchDistance(first, second, dtype, normType=kind, K=two)
        distance = distance.astype(np.float32)
        if two == 1:
            return nearest[:, 0], distance[:, 0]
        clear = distance[:, 0] < self._ratio * distance[:, 1]
        return np.where(clear, nearest[:, 0], -1), distance[:, 0]
