"""The design of a race: method indicators, blocks of pairs and the order of pairs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.dataset import Pair
from aerocues.tuning.scales import Array

KIND = ("detector", "descriptor")


def features(components: Mapping[str, Sequence[str]]) -> tuple[Array, NDArray[np.int64]]:
    """(A, K) indicators, 1 for each method of an alternative, and (K,) the group of each column.

    Each detector-descriptor pair has a column of its own: their interaction.
    """
    labelled = list(components.values())
    if set(KIND) <= set(components):
        labelled.append(
            ["-".join(pair) for pair in zip(*(components[k] for k in KIND), strict=True)]
        )
    columns, groups = [], []
    for group, labels in enumerate(labelled):
        for name in sorted(set(labels)):
            columns.append([float(label == name) for label in labels])
            groups.append(group)
    return np.array(columns).T, np.array(groups)


def blocks_of(pairs: Sequence[Pair]) -> NDArray[np.int64]:
    """(P,) number of each pair's sequence."""
    return np.unique([pair.sequence for pair in pairs], return_inverse=True)[1].astype(np.int64)


def kinds_of_pairs(blocks: NDArray[np.int64], classes: NDArray[np.int64]) -> NDArray[np.int64]:
    """(P,) number of each pair's block and class together.

    Methods without orientation fail on all pairs of a class: what was measured on others says
    nothing of these.
    """
    both = np.stack([blocks, classes], axis=1)
    return np.unique(both, axis=0, return_inverse=True)[1].reshape(-1).astype(np.int64)


def spread_order(blocks: NDArray[np.int64], rng: np.random.Generator) -> NDArray[np.intp]:
    """Pairs in random order, one of each block, then the second of each, and so on."""
    place = np.zeros(len(blocks), np.intp)
    for block in np.unique(blocks):
        members = np.flatnonzero(blocks == block)
        place[rng.permutation(members)] = np.arange(len(members))
    return np.lexsort((rng.permutation(len(blocks)), place))
