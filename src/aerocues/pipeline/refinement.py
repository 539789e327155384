"""Sharper keypoints: the observations of each track, moved to where their patches look alike."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from aerocues.methods.arrays import Float32Array, Matches
from aerocues.pipeline.local_motion import homography_of, jacobians, local_motion
from aerocues.pipeline.patch_matching import gaussian_weights, match_patches
from aerocues.pipeline.protocol import REFINEMENT, Refinement
from aerocues.pipeline.tracks import Ints, Tracks, tracks_of

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]
GrayImages = Callable[[int], Float32Array]
"""From the number of an image to its slightly blurred gray values, (H, W) float32."""


@dataclass(frozen=True, eq=False)
class RefinedKeypoints:
    """Keypoints of some images after their tracks were refined.

    Parameters
    ----------
    xy : list of (N, 2) float32
        Positions by image; those of references, of rejected and of unmatched keypoints are as
        they were.
    rejected : list of (N,) bool
        Observations that look unlike their reference.
    observations, accepted, accepted_at_once : int
        Observations besides the references, how many of them were accepted, and how many of those
        without the help of refined neighbours.
    shift : float or None
        Median of the pixels by which accepted observations were moved.
    disagreement, disagreement_before : float or None
        Median distance in pixels of accepted observations from where their neighbours say that
        they lie, after and before.
    """

    xy: list[Float32Array]
    rejected: list[Bools]
    observations: int
    accepted: int
    accepted_at_once: int
    shift: float | None
    disagreement: float | None
    disagreement_before: float | None


def refine_tracks(
    images: GrayImages,
    keypoints: Sequence[Float32Array],
    pairs: Mapping[tuple[int, int], Matches],
    refinement: Refinement = REFINEMENT,
    scale: float = 1.0,
) -> RefinedKeypoints:
    """Refine keypoints by least-squares matching with the reference of their track.

    Parameters
    ----------
    images : callable
        Gives gray images by number; called again for an image that is needed again.
    keypoints : sequence of (N, 2) float32
        Positions by image, in pixels of the images that features were found in; the centre of the
        top-left pixel is (0, 0).
    pairs : mapping of pairs of images to Matches
        Verified matches.
    refinement : Refinement
    scale : float
        Pixels of `images` to one of the images that features were found in.

    Returns
    -------
    RefinedKeypoints
        The same bytes for the same arguments.
    """
    tracks = tracks_of([len(each) for each in keypoints], pairs)
    found = np.concatenate([np.empty((0, 2)), *keypoints]).astype(np.float64)
    work = _Work(images, tracks, (found + 0.5) * scale - 0.5, refinement, scale)
    work.first_pass()
    at_once = int(work.accepted.sum())
    work.second_pass()
    return work.result(at_once)


def _references(tracks: Tracks, xy: Floats) -> tuple[Ints, Ints]:
    """Observations and the reference of each: the one of its track with the most matches.

    Of equals the one nearest to the middle of its image: it is seen least askew.
    """
    members = np.flatnonzero(tracks.track >= 0)
    outside = np.zeros(len(xy))
    for start, end in zip(tracks.first[:-1], tracks.first[1:], strict=True):
        here = xy[start:end]
        if len(here):
            middle = (here.min(axis=0) + here.max(axis=0)) / 2
            outside[start:end] = np.linalg.norm(here - middle, axis=1)
    order = members[np.lexsort((outside[members], -tracks.degree[members], tracks.track[members]))]
    begins = np.diff(tracks.track[order], prepend=-1) != 0
    references = order[np.maximum.accumulate(np.where(begins, np.arange(len(order)), 0))]
    return order[~begins], references[~begins]


class _Work:
    """Positions on their way, in pixels of the images that are compared."""

    def __init__(
        self, images: GrayImages, tracks: Tracks, xy: Floats, refinement: Refinement, scale: float
    ) -> None:
        self._images, self._tracks, self._how, self._scale = images, tracks, refinement, scale
        self._weights = gaussian_weights(refinement.half_window, refinement.sigma)
        self._observations, self._references = _references(tracks, xy)
        self._before, self.xy = xy, xy.copy()
        self._warps = np.zeros((len(self._observations), 2, 2))
        self.accepted = np.zeros(len(self._observations), bool)

    def first_pass(self) -> None:
        """Match every observation from where its keypoint was found."""
        anyone = self._tracks.track >= 0
        for rows, pair in self._pairs():
            motion = self._motion(rows, pair, anyone, self._before, 2 * self._scale)
            if motion is not None:
                self._match(rows, pair, motion[0], self.xy[self._observations[rows]])

    def second_pass(self) -> None:
        """Match those that were rejected again, from where accepted neighbours say they lie."""
        sure = self._sure()
        for rows, pair in self._pairs(~self.accepted):
            motion = self._motion(rows, pair, sure, self.xy, self._scale)
            if motion is not None:
                self._match(rows, pair, motion[0], motion[1], self._how.recovery)

    def disagreement(self, xy: Floats) -> float | None:
        """Median distance of accepted observations from where their neighbours say they lie."""
        sure, distances = self._sure(), [np.empty(0)]
        for rows, pair in self._pairs(self.accepted):
            motion = self._motion(rows, pair, sure, xy, self._scale)
            if motion is not None:
                away = motion[1] - xy[self._observations[rows]]
                distances.append(np.linalg.norm(away, axis=1) / self._scale)
        joined = np.concatenate(distances)
        return float(np.median(joined)) if len(joined) else None

    def result(self, at_once: int) -> RefinedKeypoints:
        """What has become of the keypoints, in pixels of the images that features were found in."""
        moved = self._observations[self.accepted]
        shifts = np.linalg.norm(self.xy[moved] - self._before[moved], axis=1) / self._scale
        rejected = np.zeros(len(self.xy), bool)
        rejected[self._observations[~self.accepted]] = True
        found = ((self.xy + 0.5) / self._scale - 0.5).astype(np.float32)
        cuts = self._tracks.first[1:-1]
        return RefinedKeypoints(
            xy=np.split(found, cuts),
            rejected=np.split(rejected, cuts),
            observations=len(self._observations),
            accepted=len(moved),
            accepted_at_once=at_once,
            shift=float(np.median(shifts)) if len(moved) else None,
            disagreement=self.disagreement(self.xy),
            disagreement_before=self.disagreement(self._before),
        )

    def _sure(self) -> Bools:
        """References and accepted observations."""
        sure = np.zeros(len(self.xy), bool)
        sure[self._references] = True
        sure[self._observations[self.accepted]] = True
        return sure

    def _pairs(self, which: Bools | None = None) -> Iterator[tuple[Ints, tuple[int, int]]]:
        """Observations by the pair of images of their reference and of themselves."""
        rows = np.arange(len(self._observations)) if which is None else np.flatnonzero(which)
        image = self._tracks.image
        one, other = image[self._references[rows]], image[self._observations[rows]]
        order = np.lexsort((other, one))
        rows, one, other = rows[order], one[order], other[order]
        cuts = np.flatnonzero(np.diff(one) | np.diff(other)) + 1
        for part in np.split(np.arange(len(rows)), cuts):
            if len(part):
                yield rows[part], (int(one[part[0]]), int(other[part[0]]))

    def _match(
        self,
        rows: Ints,
        pair: tuple[int, int],
        warps: Floats,
        starts: Floats,
        farthest: float | None = None,
    ) -> None:
        """Match patches and keep what looks alike, near to where it was looked for."""
        how = self._how
        shifts, likeness = match_patches(
            self._images(pair[0]),
            self._images(pair[1]),
            self.xy[self._references[rows]],
            np.ascontiguousarray(starts),
            warps,
            self._weights,
            how.steps,
        )
        limit = (how.farthest if farthest is None else farthest) * self._scale
        good = (likeness >= how.likeness) & (np.linalg.norm(shifts, axis=1) <= limit)
        self.xy[self._observations[rows[good]]] = (starts + shifts)[good]
        self.accepted[rows[good]] = True

    def _motion(
        self, rows: Ints, pair: tuple[int, int], usable: Bools, xy: Floats, loose: float
    ) -> tuple[Floats, Floats] | None:
        """Warps around the references of rows, and where neighbours say the observations lie."""
        first, second = self._common(pair, usable)
        points, ends = xy[first], xy[second]
        homography = homography_of(points, ends)
        count = self._how.neighbours
        if homography is None or len(points) <= count:
            return None
        at = xy[self._references[rows]]
        near = cKDTree(points).query(at, count + 1)[1]
        itself = first[near] == self._references[rows][:, None]
        keep = np.argsort(itself, axis=1, kind="stable")[:, :count]
        near = np.take_along_axis(near, keep, axis=1).astype(np.int64)
        return local_motion(points, ends, near, at, jacobians(homography, at), loose)

    def _common(self, pair: tuple[int, int], usable: Bools) -> tuple[Ints, Ints]:
        """Keypoints of the tracks that both images of a pair see."""
        tracks = self._tracks
        one, other = (
            np.flatnonzero(usable[tracks.first[each] : tracks.first[each + 1]]) + tracks.first[each]
            for each in pair
        )
        _, here, there = np.intersect1d(
            tracks.track[one], tracks.track[other], assume_unique=True, return_indices=True
        )
        return one[here], other[there]
