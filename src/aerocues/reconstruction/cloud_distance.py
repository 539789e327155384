"""Cloud-to-cloud distances to the nearest point, as in CloudCompare."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aerocues.reconstruction.alignment import root_mean_square, similarity
from aerocues.results.clouds import Cloud
from aerocues.results.metrics import Row

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class CloudDistances:
    """Distances of each point to the other cloud, in both directions, in the reference frame."""

    to_reference: Array
    from_reference: Array

    def figures(self) -> Row:
        """Median, root mean square and 95th percentile, in both directions."""
        return {
            **_statistics("cloud_distance", self.to_reference),
            **_statistics("reference_distance", self.from_reference),
        }


def _statistics(name: str, distances: Array) -> Mapping[str, float]:
    return {
        f"{name}_median": float(np.median(distances)),
        f"{name}_rms": root_mean_square(distances),
        f"{name}_p95": float(np.quantile(distances, 0.95)),
    }


def cloud_distances(cloud: Cloud, reference: Cloud) -> CloudDistances | None:
    """Align a cloud with a reference by their common cameras, and measure the distances.

    Parameters
    ----------
    cloud, reference : Cloud

    Returns
    -------
    CloudDistances or None
        None if fewer than three cameras are shared, they lie on a line, or a cloud is empty.
    """
    from scipy.spatial import cKDTree

    shared, mine, theirs = np.intersect1d(cloud.names, reference.names, return_indices=True)
    if not len(shared) or not len(cloud.points) or not len(reference.points):
        return None
    place = similarity(
        cloud.centres[mine].astype(np.float64), reference.centres[theirs].astype(np.float64)
    )
    if place is None:
        return None
    points = place.apply(cloud.points.astype(np.float64))
    others = reference.points.astype(np.float64)
    return CloudDistances(
        np.asarray(cKDTree(others).query(points)[0]), np.asarray(cKDTree(points).query(others)[0])
    )
