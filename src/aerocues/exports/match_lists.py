"""Matches as text: pairs of numbers of images, each with the pairs of numbers of its keypoints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from aerocues.exports.flight import Indices
from aerocues.reconstruction.matched_scene import Names


def match_list(images: Sequence[str], matches: Mapping[Names, Indices]) -> str:
    """``I J``, the number of matches, then a line for each; I is below J.

    Parameters
    ----------
    images : sequence of str
        In the order of their numbers, which begin at 0.
    matches : mapping of pairs to (M, 2) int32
        Indices of keypoints.
    """
    numbers = {name: number for number, name in enumerate(images)}
    listed: list[tuple[int, int, NDArray[np.int32]]] = []
    for (first, second), indices in matches.items():
        one, two = numbers[first], numbers[second]
        ordered = (one, two, indices) if one < two else (two, one, indices[:, ::-1])
        listed.append(ordered)
    lines = []
    for one, two, indices in sorted(listed, key=lambda each: each[:2]):
        lines += [f"{one} {two}", str(len(indices))]
        lines += [f"{left} {right}" for left, right in indices.tolist()]
    return "".join(f"{line}\n" for line in lines)
