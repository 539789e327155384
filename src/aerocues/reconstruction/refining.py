"""Sharper keypoints of a scene, before COLMAP gets them."""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.dataset import Dataset
from aerocues.methods.arrays import Float32Array, Matches
from aerocues.pipeline.patch_matching import as_gray
from aerocues.pipeline.protocol import Refinement
from aerocues.pipeline.refinement import RefinedKeypoints, refine_tracks
from aerocues.reconstruction.matched_scene import MatchedScene, PairMatches
from aerocues.results.metrics import Row

Rejected = NDArray[np.bool_]
GRAY_BYTES = 256 * 2**20


class GrayImages:
    """Gray images by number; those used last are kept in memory, as many as fit.

    Parameters
    ----------
    dataset : Dataset
    blur : float
        Sigma in pixels.
    most : int
        Bytes that are kept.
    """

    def __init__(self, dataset: Dataset, blur: float, most: int = GRAY_BYTES) -> None:
        self._dataset, self._blur, self._most = dataset, blur, most
        self._kept: OrderedDict[int, Float32Array] = OrderedDict()

    def __call__(self, number: int) -> Float32Array:
        if number not in self._kept:
            pixels = self._dataset.images[number].read()
            self._kept[number] = as_gray(pixels.bgr, self._blur)
        self._kept.move_to_end(number)
        while len(self._kept) > 2 and self._bytes() > self._most:
            self._kept.popitem(last=False)
        return self._kept[number]

    def _bytes(self) -> int:
        return sum(image.nbytes for image in self._kept.values())


def refine_scene(
    dataset: Dataset,
    matched: MatchedScene,
    refinement: Refinement,
    scale: float = 1.0,
) -> tuple[MatchedScene, RefinedKeypoints]:
    """A scene whose keypoints lie where their tracks look alike.

    Parameters
    ----------
    dataset : Dataset
    matched : MatchedScene
        With matches that agree with the geometry of their pair.
    refinement : Refinement
    scale : float
        Pixels of the images to one of those that features were found in.

    Returns
    -------
    MatchedScene
        With the matches of observations that look unlike the rest of their track left out.
    RefinedKeypoints

    Raises
    ------
    ImageError
        If an image can no longer be read.
    """
    names = list(matched.keypoints)
    number = {name: position for position, name in enumerate(names)}
    pairs = {
        (number[first], number[second]): Matches(each.indices, each.distance)
        for (first, second), each in matched.pairs.items()
    }
    found = refine_tracks(
        GrayImages(dataset, refinement.blur),
        [_scaled(matched.keypoints[name].xy, 1 / scale) for name in names],
        pairs,
        refinement,
        scale,
    )
    keypoints = {
        name: replace(matched.keypoints[name], xy=_scaled(xy, scale))
        for name, xy in zip(names, found.xy, strict=True)
    }
    rejected = dict(zip(names, found.rejected, strict=True))
    kept = {
        (first, second): _without(matches, rejected[first], rejected[second])
        for (first, second), matches in matched.pairs.items()
    }
    return replace(matched, keypoints=keypoints, pairs=kept), found


def _scaled(xy: Float32Array, scale: float) -> Float32Array:
    """Pixels of larger or smaller images; the centre of the top-left pixel is (0, 0)."""
    if scale == 1.0:
        return xy
    return ((xy + 0.5) * scale - 0.5).astype(np.float32)


def warm_up_refinement(refinement: Refinement) -> None:
    """Compile what refines keypoints, so that no model is charged for it."""
    random = np.random.default_rng(0)
    images = random.uniform(0, 255, (2, 64, 64)).astype(np.float32)
    grid = np.stack(np.meshgrid(*[np.arange(16, 49, 8)] * 2), axis=-1).reshape(-1, 2)
    points = grid.astype(np.float32)
    numbers = np.arange(len(points), dtype=np.int32)
    matches = Matches(np.stack([numbers, numbers], axis=1), np.zeros(len(points), np.float32))
    refine_tracks(lambda number: images[number], [points] * 2, {(0, 1): matches}, refinement)


def refinement_figures(found: RefinedKeypoints) -> Row:
    """What refining did, as columns of a model."""
    observations, after = found.observations, found.disagreement
    return {
        "refinable_share": found.accepted_at_once / observations if observations else None,
        "refined_share": found.accepted / observations if observations else None,
        "refinement_shift": found.shift,
        "refinement_gain": found.disagreement_before / after
        if found.disagreement_before is not None and after
        else None,
    }


def _without(matches: PairMatches, first: Rejected, second: Rejected) -> PairMatches:
    return matches.chosen(~(first[matches.indices[:, 0]] | second[matches.indices[:, 1]]))
