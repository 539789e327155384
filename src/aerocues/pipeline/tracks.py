"""Tracks: the keypoints of several images that matches say are one point of the scene."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aerocues.compiled import compiled
from aerocues.methods.arrays import Matches

Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Tracks:
    """Which keypoints belong together; keypoints are numbered through all images, in their order.

    Parameters
    ----------
    image : (K,) int64
        Number of each keypoint's image.
    first : (I + 1,) int64
        Number of the first keypoint of each image, and at last how many there are.
    track : (K,) int64
        The track of each keypoint, -1 where it has no match. No track holds two of an image.
    degree : (K,) int64
        How many matches each keypoint has.
    """

    image: Ints
    first: Ints
    track: Ints
    degree: Ints


def tracks_of(counts: Sequence[int], pairs: Mapping[tuple[int, int], Matches]) -> Tracks:
    """Join matches to tracks: those of the closest descriptors first.

    A match that would put two keypoints of an image into a track is left out: one of the two is
    wrong, and more often the one with the larger distance.

    Parameters
    ----------
    counts : sequence of int
        Keypoints of each image.
    pairs : mapping of pairs of images to Matches
        Verified ones, under one norm.
    """
    first = np.concatenate([[0], np.cumsum(counts, dtype=np.int64)])
    image = np.repeat(np.arange(len(counts)), counts)
    ends = [matches.indices + first[list(pair)] for pair, matches in pairs.items()]
    joined = np.concatenate([np.empty((0, 2), np.int64), *ends])
    distances = [matches.distance for matches in pairs.values()]
    order = np.argsort(np.concatenate([np.empty(0, np.float32), *distances]), kind="stable")
    track = _joined(joined[order], image, len(counts))
    degree = np.bincount(joined.ravel(), minlength=len(image))
    return Tracks(image, first, np.where(degree > 0, track, -1), degree)


@compiled
def _root(parent: Ints, member: int) -> int:
    while parent[member] != member:
        parent[member] = parent[parent[member]]
        member = parent[member]
    return member


@compiled
def _joined(matches: Ints, image: Ints, images: int) -> Ints:
    """The least keypoint of each keypoint's track: a union of sets that knows their members."""
    parent = np.arange(len(image))
    following = np.arange(len(image))  # the members of a set, in a ring
    met = np.full(images, -1)
    for number in range(len(matches)):
        one, other = _root(parent, matches[number, 0]), _root(parent, matches[number, 1])
        if one == other:
            continue
        member = one
        while True:
            met[image[member]] = number
            member = following[member]
            if member == one:
                break
        member, clash = other, False
        while True:
            clash = clash or met[image[member]] == number
            member = following[member]
            if member == other:
                break
        if not clash:
            parent[max(one, other)] = min(one, other)
            following[one], following[other] = following[other], following[one]
    for member in range(len(image)):
        parent[member] = _root(parent, member)
    return parent
