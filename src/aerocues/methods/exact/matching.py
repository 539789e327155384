"""The matcher EXACT: the matches of cross-checked brute force, by other means."""

from __future__ import annotations

import numpy as np

from aerocues.errors import SelectionError
from aerocues.methods.arrays import DescriptorArray, Features, Matches
from aerocues.methods.exact import brute_force, euclidean, hamming

class ExactMatcher:
    """Exact nearest neighbours, cross-checked; a `aerocues.methods.interfaces.Matcher`."""

    def match(self, features_1: Features, features_2: Features, norm: str) -> Matches:
        return mutual_nearest(features_1, features_2, norm)


def mutual_nearest(features_1: Features, features_2: Features, norm: str) -> Matches:
    """Match each feature with its nearest where that one's nearest is the feature, too.

    The result is that of ``cv2.BFMatcher(norm, crossCheck=True).match``: the same pairs in the
    same order with the same distances; of equally near ones the first counts.

    Parameters
    ----------
    features_1, features_2 : Features
        N and M features; descriptors of the same type and number of columns.
    norm : {"L2", "HAM"}

    Returns
    -------
    Matches

    Raises
    ------
    SelectionError
        If the descriptors cannot be compared under the norm.
    """
    first, second = features_1.descriptors, features_2.descriptors
    _check(first, second, norm)
    if not len(first) or not len(second):
        return Matches()
    if norm == "HAM":
        return by_bits(first, second)
    return by_distance(first, second)


def by_bits(first, second):
    if first.shape[1] > hamming.LONGEST_DESCRIPTOR or len(first) * len(second) < SMALL:
        return brute_force.mutual(first, second, "HAM")
    distances, forth, back = hamming.nearest_both_ways(first, second)
    indices = _mutual(forth, back)
    return Matches(indices, distances[indices[:, 0]].astype(np.float32))


def by_distance(first, second):
    nearest = None if len(first) * len(second) < SMALL else euclidean.nearest_both_ways(first, second)
    if nearest is None:
        return brute_force.mutual(first, second, "L2")
    indices = _mutual(*nearest)
    distances = brute_force.euclidean_distances(first, second, indices[:, 0], indices[:, 1])
    return Matches(indices, distances)

SMALL = 0

def _mutual(forth, back):
    rows = np.flatnonzero(back[forth] == np.arange(len(forth)))
    return np.stack([rows, forth[rows]], axis=1).astype(np.int32)


def _check(first: DescriptorArray, second: DescriptorArray, norm: str) -> None:
    pass
