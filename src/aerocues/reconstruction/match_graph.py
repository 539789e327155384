"""The graph of images that are linked by pairs, and its connected components."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

LISTED = 3


def parts_of(images: Sequence[str], pairs: Iterable[tuple[str, str]]) -> list[list[str]]:
    """The connected components, the largest first; each image is in one of them."""
    number = {name: position for position, name in enumerate(images)}
    ends = np.array([[number[a], number[b]] for a, b in pairs], int).reshape(-1, 2)
    graph = coo_matrix(
        (np.ones(len(ends)), (ends[:, 0], ends[:, 1])), shape=(len(images), len(images))
    )
    _, labels = connected_components(graph, directed=False)
    parts: dict[int, list[str]] = {}
    for name, label in zip(images, labels, strict=True):
        parts.setdefault(int(label), []).append(name)
    return sorted(parts.values(), key=lambda part: (-len(part), number[part[0]]))


def told_parts(parts: Sequence[Sequence[str]]) -> str:
    """``2 parts: 9 images (a, b, c, ...) and 7 (d, e, f, ...)``; single images together."""
    several = [part for part in parts if len(part) > 1]
    single = [part[0] for part in parts if len(part) == 1]
    told = [f"{len(part)} images ({_listed(part)})" for part in several]
    if single:
        told.append(f"{len(single)} without links ({_listed(single)})")
    return f"{len(parts)} parts: {', '.join(told)}"


def _listed(names: Sequence[str]) -> str:
    return ", ".join(names[:LISTED]) + (", ..." if len(names) > LISTED else "")
