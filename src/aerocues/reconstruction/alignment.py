"""Similarity between two frames, and how far cameras are from where they were."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
FEWEST = 3
# Of the second to the first singular value: below, points lie on a line.
ON_A_LINE = 1e-3


@dataclass(frozen=True, eq=False)
class Similarity:
    """Maps x to ``scale * rotation @ x + translation``."""

    scale: float
    rotation: Array
    translation: Array

    def apply(self, points: Array) -> Array:
        """Points, (N, 3)."""
        return self.scale * points @ self.rotation.T + self.translation


def similarity(source: Array, target: Array) -> Similarity | None:
    """The similarity that brings points closest to others, by least squares.

    Parameters
    ----------
    source, target : (N, 3) float64

    Returns
    -------
    Similarity or None
        None where it is not determined: fewer than 3 points, or all on a line.

    References
    ----------
    Umeyama, Least-squares estimation of transformation parameters between two point patterns,
    IEEE PAMI 13 (1991).
    """
    if len(source) < FEWEST:
        return None
    mean_source, mean_target = source.mean(axis=0), target.mean(axis=0)
    from_mean, to_mean = source - mean_source, target - mean_target
    if _on_a_line(from_mean) or _on_a_line(to_mean):
        return None
    left, values, right = np.linalg.svd(to_mean.T @ from_mean)
    signs = np.array([1.0, 1.0, np.sign(np.linalg.det(left) * np.linalg.det(right))])
    rotation = (left * signs) @ right
    scale = float((values * signs).sum() / (from_mean**2).sum())
    return Similarity(scale, rotation, mean_target - scale * rotation @ mean_source)


def _on_a_line(centred: Array) -> bool:
    values = np.linalg.svd(centred, compute_uv=False)
    return bool(values[1] <= ON_A_LINE * values[0])


def extent(positions: Array) -> float:
    """Diagonal of the box around positions, (N, 3), in their unit."""
    return float(np.linalg.norm(np.ptp(positions, axis=0)))


def root_mean_square(values: Array) -> float:
    """Square root of the mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def rotation_angles(first: Array, second: Array) -> Array:
    """Angles in degrees between rotations, (N, 3, 3) each."""
    cosines = (np.einsum("nij,nij->n", first, second) - 1) / 2
    angles: Array = np.degrees(np.arccos(np.clip(cosines, -1, 1)))
    return angles
