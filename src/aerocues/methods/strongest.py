"""Equal footing for detectors: each gives its best so many keypoints."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from aerocues.methods.arrays import Keypoints
from aerocues.methods.registry import Methods


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


def strongest(keypoints: Keypoints, count: int, seed: int) -> Keypoints:
    """The keypoints with the highest response, in the order in which they came.

    Parameters
    ----------
    keypoints : Keypoints
    count : int
        How many to keep; 0 keeps all.
    seed : int
        Decides among equal responses: some detectors give none, and the first in their list are
        those of one part of the image.
    """
    if not count or len(keypoints) <= count:
        return keypoints
    chance = np.random.default_rng(seed).permutation(len(keypoints))
    best = np.lexsort((chance, -keypoints.response))[:count]
    return keypoints.take(np.sort(best))
