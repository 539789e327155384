"""OpenCV's own answers, in arrays: for what is small, and for what only its arithmetic decides."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from aerocues.methods.arrays import DescriptorArray, Float32Array, Matches

NORMS = {"L2": (cv2.NORM_L2, cv2.CV_32F), "HAM": (cv2.NORM_HAMMING, cv2.CV_32S)}
"""For each norm OpenCV's constant, and the type of its distances."""

# Pairs whose distances are asked for in one call: each has a place on the diagonal of a table, the
# rest of which is masked. Larger tables waste more, fewer calls cost less.
TOGETHER = 64


def mutual(first: DescriptorArray, second: DescriptorArray, norm: str) -> Matches:
    """The answer of ``cv2.BFMatcher(norm, crossCheck=True)``, without its list of objects."""
    constant, dtype = NORMS[norm]
    distances, nearest = cv2.batchDistance(
        first, second, dtype, normType=constant, K=1, crosscheck=True
    )
    (rows,) = (nearest[:, 0] >= 0).nonzero()
    indices = np.empty((len(rows), 2), np.int32)
    indices[:, 0], indices[:, 1] = rows, nearest[rows, 0]
    return Matches(indices, distances[rows, 0].astype(np.float32))


def euclidean_distances(
    first: DescriptorArray,
    second: DescriptorArray,
    rows: NDArray[np.integer[Any]],
    columns: NDArray[np.integer[Any]],
) -> Float32Array:
    """Distances of single pairs, bit for bit as the brute force matcher has them.

    Parameters
    ----------
    first, second : (N, D) and (M, D) uint8 or float32
    rows, columns : (P,) int
        Which row of `first` and which of `second` form each pair.

    Returns
    -------
    (P,) float32
    """
    found = np.empty(len(rows), np.float32)
    diagonal = np.eye(TOGETHER, dtype=np.uint8)
    for start in range(0, len(rows), TOGETHER):
        part = slice(start, start + TOGETHER)
        left, right = first[rows[part]], second[columns[part]]
        mask = diagonal[: len(left), : len(left)]
        distances, _ = cv2.batchDistance(
            left, right, cv2.CV_32F, normType=cv2.NORM_L2, K=1, mask=mask
        )
        found[part] = distances[:, 0]
    return found
