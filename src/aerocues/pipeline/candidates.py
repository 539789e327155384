"""Which pairs of images are worth a look: neighbours by GPS, or images that look alike."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.dataset import GpsPosition
from aerocues.datasets.usable_gps import UsableGps
from aerocues.methods.arrays import Features

NEIGHBOURS = 10
"""Nearest images by GPS that are looked at: those of the own strip and of the next ones."""
LOOK_ALIKES = 12
# So many images are looked at pair by pair; of more, those that look alike.
MOST_EXHAUSTIVE = 40
STRONGEST = 150
RATIO = 0.8

Positions = tuple[int, int]


def candidate_pairs(
    positions: Sequence[GpsPosition | None], features: Sequence[Features]
) -> list[Positions]:
    """Pairs of images that may overlap, by their numbers, each once and in order.

    Parameters
    ----------
    positions : sequence of GpsPosition or None
        Of the images, in the order of the flight.
    features : sequence of Features
        With float32 descriptors.

    Returns
    -------
    list of tuple of int
        Consecutive images are always among them: GPS can be wrong.
    """
    count = len(features)
    found = {(i, i + 1) for i in range(count - 1)}
    located = UsableGps.of(positions).horizontal()
    if located is not None and count > 2 and len(set(positions)) > count // 2:
        found |= _nearest(located)
    elif count <= MOST_EXHAUSTIVE:
        found |= {(i, j) for i in range(count) for j in range(i + 1, count)}
    else:
        found |= _alike(features)
    return sorted(found)


def _nearest(positions: NDArray[np.float64]) -> set[Positions]:
    from scipy.spatial import cKDTree

    near = min(NEIGHBOURS + 1, len(positions))
    _, indices = cKDTree(positions).query(positions, k=near)
    return {
        (min(i, int(j)), max(i, int(j)))
        for i, row in enumerate(indices.reshape(len(positions), near))
        for j in row
        if i != j
    }


def _alike(features: Sequence[Features]) -> set[Positions]:
    """Each image with those that share most of its strongest features."""
    strongest = [_unit(each) for each in features]
    count = len(strongest)
    shared = np.zeros((count, count), np.int64)
    for i in range(count):
        for j in range(i + 1, count):
            shared[i, j] = shared[j, i] = _matches(strongest[i], strongest[j])
    found = set()
    for i in range(count):
        for j in np.argsort(-shared[i], kind="stable")[:LOOK_ALIKES]:
            if shared[i, j]:
                found.add((min(i, int(j)), max(i, int(j))))
    return found


def _unit(features: Features) -> NDArray[np.float32]:
    """The descriptors of the strongest keypoints, of length 1."""
    order = np.argsort(-features.keypoints.response, kind="stable")[:STRONGEST]
    descriptors = features.descriptors[order].astype(np.float32)
    lengths = np.linalg.norm(descriptors, axis=1, keepdims=True)
    return np.asarray(descriptors / np.maximum(lengths, 1e-9), np.float32)


def _matches(first: NDArray[np.float32], second: NDArray[np.float32]) -> int:
    """Mutual matches that are clearly nearer than the second nearest (Lowe's ratio)."""
    if len(first) < 2 or len(second) < 2:
        return 0
    likeness = first @ second.T
    best, back = likeness.argmax(axis=1), likeness.argmax(axis=0)
    rows = np.arange(len(first))
    mutual = back[best] == rows
    two = np.partition(likeness, -2, axis=1)[:, -2:]
    distance = np.sqrt(np.maximum(2.0 - 2.0 * two, 0.0))
    return int((mutual & (distance[:, 1] < RATIO * distance[:, 0])).sum())
