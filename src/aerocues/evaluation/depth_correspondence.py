"""True positions of points of one image in the other image, from poses, intrinsics and depth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from aerocues.datasets.true_geometry import (
    Array,
    Located,
    Points,
    find_seen,
    inverse_depths,
    project,
)


@dataclass(frozen=True, eq=False)
class DepthCorrespondence:
    """Two images of a scene with known poses, intrinsics and depth.

    At a depth edge, such as the edge of a roof, a point may belong to two surfaces; the better fit
    counts.
    """

    first: Located
    second: Located

    def errors(self, points_1: Points, points_2: Points) -> Array:
        found = np.full(len(points_1), np.inf)
        for inverse in inverse_depths(points_1, self.first.inverse):
            moved, _ = project(points_1, inverse, self.first.view, self.second.view)
            distance = np.linalg.norm(moved - points_2, axis=1)
            found = np.fmin(found, distance)
        return found

    def shared(self, points_1: Points, points_2: Points) -> tuple[Array, Array]:
        moved, seen = find_seen(points_1, self.first, self.second)
        _, seen_back = find_seen(points_2, self.second, self.first)
        return moved[seen], np.asarray(points_2, np.float64)[seen_back]
