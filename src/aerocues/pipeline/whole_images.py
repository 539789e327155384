"""What a pair matcher finds in two images, in the form that other combinations give it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from aerocues.methods.arrays import Features, Float32Array, Keypoints, Matches
from aerocues.methods.pair_matching import PointMatches
from aerocues.methods.strongest import KeypointLimit
from aerocues.pipeline.features import ImageFeatures, are_valid
from aerocues.pipeline.turning import turned_points, turned_size


@dataclass(frozen=True, eq=False)
class MatchedPair:
    """Two images that were matched as a whole.

    Parameters
    ----------
    features : tuple of Features
        The positions in each image, or the keypoints that were guided; descriptors are empty.
    matches : Matches
        Of each position with the one of the same index; the distance is minus the score.
    """

    features: tuple[Features, Features]
    matches: Matches


def matched_pair(
    found: PointMatches,
    images: tuple[ImageFeatures, ImageFeatures],
    limit: KeypointLimit,
    seed: int,
) -> MatchedPair:
    """The positions that count: on valid pixels, and the surest ones up to a limit.

    Parameters
    ----------
    found : PointMatches
    images : tuple of ImageFeatures
        The first and the second image.
    limit : KeypointLimit
        Of keypoints; the score of a match takes the place of their strength.
    seed : int
        Decides among equal scores.
    """
    first, second = images
    points = _turned_back(found.points_1, first), _turned_back(found.points_2, second)
    found = PointMatches(points[0], points[1], found.scores)
    for image in images:
        own = found.points_1 if image is first else found.points_2
        if image.pixels.valid is not None:
            found = found.take(are_valid(own, image.pixels.valid))
    found = found.take(limit.kept(_keypoints(found.points_1, found), seed))
    one, other = (
        undescribed(_keypoints(points, found), image.size)
        for points, image in zip((found.points_1, found.points_2), images, strict=True)
    )
    indices = np.repeat(np.arange(len(found), dtype=np.int32)[:, None], 2, axis=1)
    return MatchedPair((one, other), Matches(indices, -found.scores))


def _turned_back(points: Float32Array, image: ImageFeatures) -> Float32Array:
    return turned_points(points, turned_size(image.size, image.turn), -image.turn)


def undescribed(keypoints: Keypoints, image_size: tuple[int, int]) -> Features:
    """Keypoints with descriptors of nothing."""
    return Features(keypoints, np.empty((len(keypoints), 0), np.float32), image_size)


def _keypoints(points: Float32Array, found: PointMatches) -> Keypoints:
    return replace(Keypoints.from_xy(points), response=found.scores)
