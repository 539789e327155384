"""Similarity transforms between two frames, and errors of camera positions."""

from __future__ import annotations

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
    scales, rotations, translations, determined = _similarities(source[None], target[None])
    if not determined[0]:
        return None
    return Similarity(float(scales[0]), rotations[0], translations[0])


def _similarities(source: Array, target: Array) -> tuple[Array, Array, Array, NDArray[np.bool_]]:
    """Scale, rotation and translation of T sets of points, (T, N, 3), and which are determined."""
    mean_source, mean_target = source.mean(axis=1), target.mean(axis=1)
    from_mean, to_mean = source - mean_source[:, None], target - mean_target[:, None]
    left, values, right = np.linalg.svd(np.swapaxes(to_mean, 1, 2) @ from_mean)
    signs = np.ones_like(values)
    signs[:, 2] = np.sign(np.linalg.det(left) * np.linalg.det(right))
    rotations = (left * signs[:, None, :]) @ right
    determined = ~(_on_a_line(from_mean) | _on_a_line(to_mean))
    spread = (from_mean**2).sum(axis=(1, 2))
    scales = (values * signs).sum(axis=1) / np.where(determined, spread, 1.0)
    translations = mean_target - scales[:, None] * np.einsum("tij,tj->ti", rotations, mean_source)
    return scales, rotations, translations, determined


def robust_similarity(
    source: Array, target: Array, tolerance: float | Array, seed: int = 0
) -> Similarity | None:
    """The similarity that maps most source points to within a tolerance of the target (RANSAC).

    Parameters
    ----------
    source, target : (N, 3) float64
    tolerance : float or (3,) float64
        In the unit of `target`: of the distance, or the half axes of an ellipsoid.
    seed : int
        Seed of the tried triples. All triples are tried if there are at most `MOST_TRIPLES`.

    Returns
    -------
    Similarity or None
        The least-squares similarity of the points within the tolerance; None if it is not
        determined.
    """
    if len(source) < FEWEST:
        return None
    triples = _triples(len(source), seed)
    scales, rotations, translations, determined = _similarities(source[triples], target[triples])
    if not determined.any():
        return similarity(source, target)
    placed = np.einsum("tij,nj->tni", scales[:, None, None] * rotations, source)
    shares = np.linalg.norm((placed + translations[:, None] - target) / tolerance, axis=2)
    shares[~determined] = np.inf
    # Most points first; of as many, those that are nearer.
    order = np.lexsort((np.median(shares, axis=1), -(shares <= 1).sum(axis=1)))
    first = int(order[0])
    best = Similarity(float(scales[first]), rotations[first], translations[first])
    near = np.linalg.norm((best.apply(source) - target) / tolerance, axis=1) <= 1
    return similarity(source[near], target[near]) or best


def _triples(count: int, seed: int) -> NDArray[np.intp]:
    if comb(count, FEWEST) <= MOST_TRIPLES:
        return np.array(list(combinations(range(count), FEWEST)))
    generator = np.random.default_rng(seed)
    return np.array(
        [generator.choice(count, FEWEST, replace=False) for _ in range(MOST_TRIPLES)], np.intp
    )


def _on_a_line(centred: Array) -> NDArray[np.bool_]:
    """Whether each set of points, (T, N, 3) about their means, lies on a line."""
    values = np.linalg.svd(centred, compute_uv=False)
    found: NDArray[np.bool_] = values[:, 1] <= ON_A_LINE * values[:, 0]
    return found


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
