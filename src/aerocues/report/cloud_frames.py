"""Brings clouds without a true scale and position into one frame, to compare them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from aerocues.reconstruction.alignment import Similarity, similarity
from aerocues.results.clouds import Cloud

METRES = "m"


def in_one_frame(clouds: Sequence[Cloud]) -> list[Cloud]:
    """The clouds in the frame of the first cloud without a scale, which is turned upright.

    Clouds in metres are unchanged. A cloud that shares too few cameras with the first keeps its own
    frame, turned upright.

    Parameters
    ----------
    clouds : sequence of Cloud
    """
    first: Cloud | None = None
    placed = []
    for cloud in clouds:
        if cloud.unit == METRES or not len(cloud.points):
            placed.append(cloud)
            continue
        place = None if first is None else _onto(cloud, first)
        upright = _moved(cloud, place or Similarity(1.0, _upright(cloud), np.zeros(3)))
        first = first or upright
        placed.append(upright)
    return placed


def _onto(cloud: Cloud, other: Cloud) -> Similarity | None:
    _, mine, theirs = np.intersect1d(cloud.names, other.names, return_indices=True)
    return similarity(
        cloud.centres[mine].astype(np.float64), other.centres[theirs].astype(np.float64)
    )


def _upright(cloud: Cloud) -> NDArray[np.float64]:
    """(3, 3) rotation that makes the plane of the points horizontal, with the cameras above."""
    points = cloud.points.astype(np.float64)
    middle = np.median(points, axis=0)
    centred = points - middle
    # Eigenvectors from the smallest to the largest spread of the points.
    up, _, across = np.linalg.eigh(centred.T @ centred)[1].T
    if (np.median(cloud.centres, axis=0) - middle) @ up < 0:
        up = -up
    return np.stack([across, np.cross(up, across), up])


def _moved(cloud: Cloud, place: Similarity) -> Cloud:
    return replace(
        cloud,
        points=_floats(place.apply(cloud.points.astype(np.float64))),
        centres=_floats(place.apply(cloud.centres.astype(np.float64))),
        rotations=_floats(place.rotation @ cloud.rotations),
    )


def _floats(values: NDArray[np.float64]) -> NDArray[np.float32]:
    return values.astype(np.float32)
