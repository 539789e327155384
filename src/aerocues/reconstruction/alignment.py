"""Similarity transforms between two frames, and errors of camera positions."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import combinations
from math import comb

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
FEWEST = 3
MOST_TRIPLES = 1000
# Ratio of the second to the first singular value; below it, points lie on a line.
ON_A_LINE = 1e-3


@dataclass(frozen=True, eq=False)
class Similarity:
    """Maps x to ``scale * rotation @ x + translation``."""

    scale: float
    rotation: Array
    translation: Array

    def apply(self, points: Array) -> Array:
        """The transformed points, (N, 3)."""
        return self.scale * points @ self.rotation.T + self.translation


def similarity(source: Array, target: Array) -> Similarity | None:
    """The least-squares similarity from source to target points.

    Parameters
    ----------
    source, target : (N, 3) float64

    Returns
    -------
    Similarity or None
        None if it is not determined: fewer than 3 points, or all points on a line.

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


def robust_similarity(
    source: Array, target: Array, tolerance: float, seed: int = 0
) -> Similarity | None:
    """The similarity that maps most source points to within a tolerance of the target (RANSAC).

    Parameters
    ----------
    source, target : (N, 3) float64
    tolerance : float
        In the unit of `target`.
    seed : int
        Seed of the tried triples. All triples are tried if there are at most `MOST_TRIPLES`.

    Returns
    -------
    Similarity or None
        The least-squares similarity of the points within the tolerance; None if it is not
        determined.
    """
    best: Similarity | None = None
    best_found = (0, -np.inf)
    for triple in _triples(len(source), seed):
        found = similarity(source[triple], target[triple])
        if found is None:
            continue
        errors = np.linalg.norm(found.apply(source) - target, axis=1)
        quality = (int((errors <= tolerance).sum()), -float(np.median(errors)))
        if quality > best_found:
            best, best_found = found, quality
    if best is None:
        return similarity(source, target)
    near = np.linalg.norm(best.apply(source) - target, axis=1) <= tolerance
    return similarity(source[near], target[near]) or best


def _triples(count: int, seed: int) -> Iterable[list[int]]:
    if comb(count, FEWEST) <= MOST_TRIPLES:
        return (list(triple) for triple in combinations(range(count), FEWEST))
    generator = np.random.default_rng(seed)
    return (generator.choice(count, FEWEST, replace=False).tolist() for _ in range(MOST_TRIPLES))


def _on_a_line(centred: Array) -> bool:
    values = np.linalg.svd(centred, compute_uv=False)
    return bool(values[1] <= ON_A_LINE * values[0])


def extent(positions: Array) -> float:
    """Diagonal of the bounding box of positions, (N, 3), in their unit."""
    return float(np.linalg.norm(np.ptp(positions, axis=0)))


def root_mean_square(values: Array) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def rotation_angles(first: Array, second: Array) -> Array:
    """Angles in degrees between rotations, (N, 3, 3) each."""
    cosines = (np.einsum("nij,nij->n", first, second) - 1) / 2
    angles: Array = np.degrees(np.arccos(np.clip(cosines, -1, 1)))
    return angles
