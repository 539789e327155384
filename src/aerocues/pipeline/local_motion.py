"""How two images differ around a point: an affine map that its neighbours agree on."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from aerocues.compiled import compiled

Floats = NDArray[np.float64]

FEWEST = 8
"""Points that a homography of two images is estimated from, at least."""
HOMOGRAPHY_THRESHOLD = 10.0
HOMOGRAPHY_TRIALS = 200
# How much the homography counts beside the neighbours, in squared pixels: as four that are this
# far away.
PULL = 4 * 20.0**2
# A neighbour that is this near counts nearly as much as one in the place itself, in pixels.
NEAR = 10.0
ROUNDS = 4


def homography_of(first: Floats, second: Floats) -> Floats | None:
    """The homography that most of the matched points (N, 2) agree with, roughly; or None."""
    import cv2

    if len(first) < FEWEST:
        return None
    found: Any = cv2.findHomography(
        first, second, cv2.RANSAC, HOMOGRAPHY_THRESHOLD, maxIters=HOMOGRAPHY_TRIALS
    )[0]
    return None if found is None else np.asarray(found, np.float64)


def jacobians(homography: Floats, points: Floats) -> Floats:
    """What a homography makes of small steps around points: (N, 2, 2)."""
    mapped = np.column_stack([points, np.ones(len(points))]) @ homography.T
    depth = mapped[:, 2, None, None]
    place = mapped[:, :2, None] / depth
    return np.asarray((homography[None, :2, :2] - place * homography[None, 2:, :2]) / depth)


@compiled
def local_motion(
    first: Floats, second: Floats, near: NDArray[np.int64], at: Floats, prior: Floats, loose: float
) -> tuple[Floats, Floats]:
    """An affine map around each place from the points that are near to it.

    Points that disagree count little, and near ones more than far ones.

    Parameters
    ----------
    first, second : (M, 2) float64
        The same points in two images.
    near : (N, K) int64
        The points near to each place.
    at : (N, 2) float64
        Places in the first image.
    prior : (N, 2, 2) float64
        The maps that are expected, without their shifts; the neighbours are drawn to them.
    loose : float
        Pixels by which a point may disagree to count half.

    Returns
    -------
    maps : (N, 2, 2) float64
        What steps in the first image are in the second one.
    places : (N, 2) float64
        Where the places lie in the second image.
    """
    maps, places = prior.copy(), np.empty_like(at)
    count = near.shape[1]
    steps, ends, weights = np.empty((count, 2)), np.empty((count, 2)), np.empty(count)
    moved = np.empty(count)
    for number in range(len(at)):
        for k in range(count):
            steps[k] = first[near[number, k]] - at[number]
            ends[k] = second[near[number, k]]
        expected, affine, place = prior[number], maps[number], places[number]
        for axis in range(2):
            for k in range(count):
                moved[k] = ends[k, axis] - (
                    affine[axis, 0] * steps[k, 0] + affine[axis, 1] * steps[k, 1]
                )
            place[axis] = np.median(moved)
        for _ in range(ROUNDS):
            for k in range(count):
                u, v = steps[k]
                x = ends[k, 0] - place[0] - affine[0, 0] * u - affine[0, 1] * v
                y = ends[k, 1] - place[1] - affine[1, 0] * u - affine[1, 1] * v
                agreement = 1 / (1 + (x * x + y * y) / (loose * loose))
                weights[k] = agreement / (NEAR * NEAR + u * u + v * v)
            _fit(steps, ends, weights, expected, affine, place)
    return maps, places


@compiled
def _fit(
    steps: Floats, ends: Floats, weights: Floats, expected: Floats, affine: Floats, place: Floats
) -> None:
    """Weighted least squares of an affine map, drawn to the expected one, in place."""
    total = weights.sum()
    middle, end = np.zeros(2), np.zeros(2)
    for k in range(len(weights)):
        middle += weights[k] / total * steps[k]
        end += weights[k] / total * ends[k]
    pull = PULL * total / len(weights)
    uu, uv, vv = pull, 0.0, pull
    moments = pull * expected
    for k in range(len(weights)):
        u, v = steps[k] - middle
        uu += weights[k] * u * u
        uv += weights[k] * u * v
        vv += weights[k] * v * v
        for axis in range(2):
            moved = weights[k] * (ends[k, axis] - end[axis])
            moments[axis, 0] += moved * u
            moments[axis, 1] += moved * v
    determinant = uu * vv - uv * uv
    for axis in range(2):
        along, down = moments[axis]
        affine[axis, 0] = (along * vv - down * uv) / determinant
        affine[axis, 1] = (down * uu - along * uv) / determinant
        place[axis] = end[axis] - affine[axis, 0] * middle[0] - affine[axis, 1] * middle[1]
