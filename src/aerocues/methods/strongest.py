"""Equal footing for detectors: each gives its best so many keypoints, or the best of each place."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from aerocues.arguments import check_whole
from aerocues.errors import ArgumentError
from aerocues.methods.arrays import Keypoints
from aerocues.methods.registry import Methods

PER_CELL = 4


def limited(methods: Methods, count: int) -> Methods:
    """The same methods, where detectors that can limit themselves give at most `count` keypoints.

    They know best: ORB spreads its own over the levels of its pyramid, and the strongest of many
    are nearly all on the finest one, which costs it scale and whole images of a model.

    Parameters
    ----------
    methods : Methods
    count : int
        0 changes nothing; nor is a limit raised.
    """
    if not count:
        return methods
    detectors = {}
    for name, row in methods.detectors.items():
        own = row.parameters.get(row.limit) if row.limit else None
        if row.limit and isinstance(own, int) and own > count:
            detectors[name] = replace(row, parameters={**row.parameters, row.limit: count})
        else:
            detectors[name] = row
    return replace(methods, detectors=detectors)


@dataclass(frozen=True)
class KeypointLimit:
    """How many keypoints of an image are kept, and which.

    Parameters
    ----------
    count : int
        0 keeps all.
    spread : bool
        The strongest of each part of the image, in place of the strongest of all.
    """

    count: int = 0
    spread: bool = False

    def limited(self, methods: Methods) -> Methods:
        """The methods as they are made under this limit; see `limited`."""
        return methods if self.spread else limited(methods, self.count)

    def keep(self, keypoints: Keypoints, seed: int) -> Keypoints:
        """The keypoints that are kept, in the order in which they came."""
        return keypoints.take(self.kept(keypoints, seed))

    def kept(self, keypoints: Keypoints, seed: int) -> NDArray[np.intp]:
        """Indices of the keypoints that are kept, in the order in which they came."""
        if not self.count or len(keypoints) <= self.count:
            return np.arange(len(keypoints))
        choose = _spread if self.spread else _strongest
        return np.sort(choose(keypoints, self.count, seed))


ALL_KEYPOINTS = KeypointLimit()


def keypoint_limit(max_keypoints: int, *, spread: bool = False) -> KeypointLimit:
    """The limit that arguments ask for.

    Raises
    ------
    ArgumentError
        If the number is not whole, 0 or more, or is missing where keypoints are to be spread.
    """
    check_whole("max_keypoints", max_keypoints, 0)
    if spread and not max_keypoints:
        raise ArgumentError(
            "`spread` chooses which keypoints are kept; give `max_keypoints` above 0, too"
        )
    return KeypointLimit(int(max_keypoints), spread)


def _ranked(keypoints: Keypoints, seed: int) -> NDArray[np.intp]:
    """Keypoints from the strongest to the weakest.

    The seed decides among equal responses: some detectors give none, and the first in their list
    are those of one part of the image.
    """
    chance = np.random.default_rng(seed).permutation(len(keypoints))
    return np.lexsort((chance, -keypoints.response))


def _strongest(keypoints: Keypoints, count: int, seed: int) -> NDArray[np.intp]:
    return _ranked(keypoints, seed)[:count]


def _spread(keypoints: Keypoints, count: int, seed: int) -> NDArray[np.intp]:
    """The strongest of each square cell, then the second of each, and so on.

    Cells are as large as would hold `PER_CELL` keypoints each if all had as many.
    """
    order = _ranked(keypoints, seed)
    low, high = keypoints.xy.min(axis=0), keypoints.xy.max(axis=0)
    area = float(np.prod(np.maximum(high - low, 1.0)))
    side = max(np.sqrt(area * PER_CELL / count), 1.0)
    columns, rows = np.floor((keypoints.xy[order] - low) / side).astype(np.int64).T
    cells = rows * (columns.max() + 1) + columns
    by_cell = np.argsort(cells, kind="stable")  # in each cell from the strongest to the weakest
    first = np.searchsorted(cells[by_cell], cells[by_cell])
    place = np.empty(len(order), np.int64)
    place[by_cell] = np.arange(len(order)) - first
    return order[np.argsort(place, kind="stable")[:count]]
