"""Keypoints matched by the positions that a pair matcher finds: it tells where to look."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from aerocues.methods.arrays import Float32Array, Keypoints, Matches
from aerocues.methods.pair_matching import PointMatches

NEIGHBOURS = 8
"""Positions that tell how the surroundings of a keypoint move."""
REACH = 24.0
"""Pixels within which they lie."""
CLOSE = 2.0
"""Pixels that a keypoint may be off the place where it should be."""


def guided_matches(found: PointMatches, first: Keypoints, second: Keypoints) -> Matches:
    """Keypoints of two images that lie where the positions of a pair matcher say, both ways.

    Parameters
    ----------
    found : PointMatches
    first, second : Keypoints
        Of the first and of the second image.

    Returns
    -------
    Matches
        The distance is that of a keypoint from where it should be, in pixels.
    """
    if len(found) < NEIGHBOURS or not len(first) or not len(second):
        return Matches()
    there, off = _nearest(transferred(first.xy, found.points_1, found.points_2), second.xy)
    back, _ = _nearest(transferred(second.xy, found.points_2, found.points_1), first.xy)
    rows = np.arange(len(first))
    kept = rows[(there >= 0) & (back[there] == rows)]
    indices = np.column_stack([kept, there[kept]]).astype(np.int32)
    return Matches(indices, off[kept].astype(np.float32))


def transferred(
    xy: Float32Array, points_1: Float32Array, points_2: Float32Array
) -> NDArray[np.float64]:
    """Where points lie in the other image: (N, 2), not a number where nothing near tells.

    An affine map is fitted to the positions around each point, the closer ones weighing more.
    """
    from scipy.spatial import cKDTree

    distance, near = cKDTree(points_1).query(xy, NEIGHBOURS)
    close: NDArray[np.bool_] = np.asarray(distance <= REACH)
    weight = np.exp(-0.5 * (distance / (REACH / 2)) ** 2) * close
    own = points_1[near].astype(np.float64) - xy[:, None].astype(np.float64)
    design = np.concatenate([np.ones((*near.shape, 1)), own], axis=2) * weight[..., None]
    wanted = points_2[near].astype(np.float64) * weight[..., None]
    # A little damping keeps positions in one line from an extreme slope.
    normal = np.einsum("nki,nkj->nij", design, design) + 1e-6 * np.eye(3)
    fitted = np.linalg.solve(normal, np.einsum("nki,nkj->nij", design, wanted))
    enough = close.sum(axis=1) >= NEIGHBOURS // 2
    return np.where(enough[:, None], fitted[:, 0], np.nan)


def _nearest(
    places: NDArray[np.float64], xy: Float32Array
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """The keypoint that is closest to each place, -1 where none is close, and how far it is."""
    from scipy.spatial import cKDTree

    known = np.isfinite(places).all(axis=1)
    which, off = np.full(len(places), -1), np.full(len(places), np.inf)
    off[known], found = cKDTree(xy).query(places[known], distance_upper_bound=CLOSE)
    which[known] = np.where(np.isfinite(off[known]), found, -1)
    return which, off
