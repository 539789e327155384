"""The matcher EXACT: the matches of cross-checked brute force, many times sooner."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from aerocues.errors import SelectionError
from aerocues.methods.arrays import DescriptorArray, Features, Int32Array, Matches
from aerocues.methods.exact import brute_force, euclidean, hamming
from aerocues.methods.matchers import EXACT

Indices = NDArray[np.integer[Any]]

# Pairs of descriptors from which on counting bits in a sweep takes less time than OpenCV.
FEWEST_PAIRS = 2000


class ExactMatcher:
    """Exact nearest neighbours, cross-checked; a `aerocues.methods.interfaces.Matcher`."""

    def match(self, features_1: Features, features_2: Features, norm: str) -> Matches:
        """Mutual matches; see `mutual_nearest`."""
        return mutual_nearest(features_1, features_2, norm)


def mutual_nearest(features_1: Features, features_2: Features, norm: str) -> Matches:
    """Match each feature with its nearest where that one's nearest is the feature, too.

    The result is that of ``cv2.BFMatcher(norm, crossCheck=True).match``, bit for bit: the same
    pairs in the same order with the same distances; of equally near features the first counts.
    Whatever is too small to gain from it, or too odd to be sure, is left to OpenCV.

    Parameters
    ----------
    features_1, features_2 : Features
        N and M features with finite descriptors of one type and number of columns.
    norm : {"L2", "HAM"}
        HAM is for uint8 only.

    Returns
    -------
    Matches

    Raises
    ------
    SelectionError
        If the norm is unknown or cannot compare the descriptors.
    """
    first, second = features_1.descriptors, features_2.descriptors
    if not len(first) or not len(second):
        return Matches()
    _check(first, second, norm)
    return _by_bits(first, second) if norm == "HAM" else _by_distance(first, second)


def _check(first: DescriptorArray, second: DescriptorArray, norm: str) -> None:
    allowed = EXACT.dtypes.get(norm)
    if allowed is None:
        raise SelectionError(f"there are no exact matches under {norm}; use L2 or HAM")
    for descriptors in (first, second):
        if descriptors.dtype not in allowed:
            raise SelectionError(
                f"exact matches under {norm} need descriptors of {' or '.join(allowed)}, not of "
                f"{descriptors.dtype}; convert them or use another norm"
            )
    if first.dtype != second.dtype or first.shape[1] != second.shape[1]:
        raise SelectionError(
            f"descriptors of {first.shape[1]} {first.dtype} and of {second.shape[1]} "
            f"{second.dtype} cannot be compared; take both from the same descriptor"
        )


def _by_bits(first: Any, second: Any) -> Matches:
    few = len(first) * len(second) < FEWEST_PAIRS
    if few or first.shape[1] > hamming.LONGEST_DESCRIPTOR:
        return brute_force.mutual(first, second, "HAM")
    distances, forth, back = hamming.nearest_both_ways(first, second)
    indices = _mutual(forth, back)
    return Matches(indices, distances[indices[:, 0]])


def _by_distance(first: DescriptorArray, second: DescriptorArray) -> Matches:
    pays = euclidean.pays(len(first), len(second), first.shape[1])
    nearest = euclidean.nearest_both_ways(first, second) if pays else None
    if nearest is None:
        return brute_force.mutual(first, second, "L2")
    indices = _mutual(*nearest)
    return Matches(indices, brute_force.euclidean_distances(first, second, *indices.T))


def _mutual(forth: Indices, back: Indices) -> Int32Array:
    """Pairs (M, 2) of which each is the other's nearest, in the order of the first."""
    rows = np.flatnonzero(back[forth] == np.arange(len(forth)))
    return np.stack([rows, forth[rows]], axis=1).astype(np.int32)
