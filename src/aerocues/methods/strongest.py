"""Equal footing for detectors: the strongest keypoints only."""

from __future__ import annotations

import numpy as np

from aerocues.methods.arrays import Keypoints


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
