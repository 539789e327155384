"""OpenCV's brute force matcher, which exact matching must equal."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from aerocues.methods.arrays import Features, Keypoints, Matches
from aerocues.methods.exact.matching import mutual_nearest

NORMS = {"L2": cv2.NORM_L2, "HAM": cv2.NORM_HAMMING}


def features(descriptors: NDArray[Any]) -> Features:
    return Features(Keypoints.from_xy(np.zeros((len(descriptors), 2))), descriptors)


def exact(first: NDArray[Any], second: NDArray[Any], norm: str) -> Matches:
    return mutual_nearest(features(first), features(second), norm)


def assert_equals_brute_force(first: NDArray[Any], second: NDArray[Any], norm: str) -> Matches:
    """The same pairs in the same order, with the same bits in their distances."""
    expected = cv2.BFMatcher(NORMS[norm], crossCheck=True).match(first, second)
    matches = exact(first, second, norm)
    pairs = [(match.queryIdx, match.trainIdx) for match in expected]
    assert [tuple(pair) for pair in matches.indices.tolist()] == pairs
    distances = np.array([match.distance for match in expected], np.float32)
    assert matches.distance.tobytes() == distances.tobytes()
    return matches
