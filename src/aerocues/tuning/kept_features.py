"""Features that a race keeps for the models of its leaders."""

from __future__ import annotations

import shutil
from collections.abc import Iterable
from pathlib import Path

from aerocues.methods.combination import Combination

MOST_KINDS = 8
"""Pairs of detector and descriptor whose features are kept: more than build models in a final."""
LEAST_FREE = 4 * 2**30
"""Bytes of the disk that must be free: eight kinds of features of 48 images take up to 1.6 GB."""


def has_room(folder: Path) -> bool:
    """Whether the disk of a folder has room for features that are only a help."""
    return shutil.disk_usage(folder).free >= LEAST_FREE


def keep_best(folder: Path, ranked: Iterable[str]) -> None:
    """Remove the features of all but the best kinds.

    Parameters
    ----------
    folder : Path
        A folder of features; see `FeatureFolder`.
    ranked : iterable of str
        Combinations, the best first.
    """
    combinations = map(Combination.parse, ranked)
    kinds = list(dict.fromkeys((each.detector, each.descriptor) for each in combinations))
    best = kinds[:MOST_KINDS]
    kept = {name for kind in best for name in (kind[0], "-".join(kind))}
    for place in folder.iterdir():
        if place.name not in kept:
            shutil.rmtree(place, ignore_errors=True)
