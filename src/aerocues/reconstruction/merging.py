"""Keypoints from the positions that a pair matcher finds anew in each pair of images.

A point that several pairs see has slightly other positions in each of them. Positions of an image
in the same cell of a grid become one keypoint, so that tracks over several images form.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from aerocues.methods.arrays import Float32Array, Int32Array, Keypoints
from aerocues.pipeline.whole_images import MatchedPair
from aerocues.reconstruction.matched_scene import Names, PairMatches

CELL = 1.0
"""Pixels of the images in which features are found; recorded with the models."""


def merged(
    images: Iterable[str], found: Mapping[Names, MatchedPair]
) -> tuple[dict[str, Keypoints], dict[Names, PairMatches]]:
    """Keypoints of the images and matches of the pairs.

    Parameters
    ----------
    images : iterable of str
    found : mapping of pairs to MatchedPair

    Returns
    -------
    dict of str to Keypoints, dict of pairs to PairMatches
        A keypoint lies at the mean of the positions in its cell. Of matches that share a keypoint
        the surest stays, so that matches are one to one.
    """
    keypoints: dict[str, Keypoints] = {}
    members: dict[tuple[Names, int], Int32Array] = {}
    for image in images:
        sides = [(names, side) for names in found for side in (0, 1) if names[side] == image]
        parts = [found[names].features[side].keypoints.xy for names, side in sides]
        keypoints[image], owners = _cells(np.concatenate([np.empty((0, 2), np.float32), *parts]))
        bounds = np.cumsum([len(part) for part in parts])[:-1]
        members.update(zip(sides, np.split(owners, bounds) if parts else (), strict=True))
    pairs = {
        names: _one_to_one(members[names, 0], members[names, 1], each.matches.distance)
        for names, each in found.items()
    }
    return keypoints, pairs


def matched_keypoints(
    images: Iterable[str], found: Mapping[Names, MatchedPair]
) -> tuple[dict[str, Keypoints], dict[Names, PairMatches]]:
    """As `merged`, where a pair matcher guides: keypoints are the same in all pairs of an image."""
    keypoints = {image: Keypoints.from_xy(np.empty((0, 2))) for image in images}
    for names, each in found.items():
        for name, features in zip(names, each.features, strict=True):
            keypoints[name] = features.keypoints
    pairs = {
        names: PairMatches(each.matches.indices, each.matches.distance)
        for names, each in found.items()
    }
    return keypoints, pairs


def _cells(xy: Float32Array) -> tuple[Keypoints, Int32Array]:
    """A keypoint for each cell that holds positions, and the keypoint of each position."""
    cells = np.floor(xy / CELL + 0.5).astype(np.int64)
    _, owners = np.unique(cells, axis=0, return_inverse=True)
    owners = owners.reshape(-1)
    count = int(owners.max()) + 1 if len(owners) else 0
    sums = np.stack([np.bincount(owners, xy[:, axis], count) for axis in (0, 1)], axis=1)
    means = sums / np.bincount(owners, minlength=count)[:, None]
    return Keypoints.from_xy(means), owners.astype(np.int32)


def _one_to_one(first: Int32Array, second: Int32Array, distance: Float32Array) -> PairMatches:
    order = np.argsort(distance, kind="stable")
    for side in (first, second):
        _, earliest = np.unique(side[order], return_index=True)
        order = order[np.sort(earliest)]
    kept = np.sort(order)
    return PairMatches(np.column_stack([first[kept], second[kept]]), distance[kept])
