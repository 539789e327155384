"""Keypoints and matches of one combination on one pair, computed again as they were measured."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.dataset import Pair
from aerocues.evaluation.unit import Context
from aerocues.methods.arrays import Features
from aerocues.methods.combination import Combination
from aerocues.pipeline.clock import Clock
from aerocues.pipeline.feature_source import FeatureSource
from aerocues.pipeline.features import ImageFeatures, StageError, unless_failed
from aerocues.pipeline.pair_stages import PairStages, matched_points
from aerocues.report.right_matches import RightMatches

Floats = NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class DrawnMatches:
    """What a picture shows.

    Attributes
    ----------
    keypoints_1, keypoints_2 : (N, 2) float32
        Pixels of the images as they were measured.
    matches : (M, 4) float32
        Points x1, y1, x2, y2.
    inliers : (M,) bool
        None of them where no model was estimated.
    verified : bool
        Whether a model was looked for.
    right : (M,) bool or None
        Whether each match is right within 3 px; None where nothing tells.
    judge : str or None
        What tells: the ground truth or the reference of the pair.
    """

    keypoints_1: Floats
    keypoints_2: Floats
    matches: Floats
    inliers: NDArray[np.bool_]
    verified: bool
    right: NDArray[np.bool_] | None = None
    judge: str | None = None

    def counts(self) -> dict[str, int | None]:
        """The counts of a measured row."""
        return {
            "keypoints_1": len(self.keypoints_1),
            "keypoints_2": len(self.keypoints_2),
            "matches": len(self.matches),
            "inliers": int(self.inliers.sum()) if self.verified else None,
        }


class Drawer:
    """Repeats measurements, with the seeds and the protocol of a run.

    Parameters
    ----------
    context : Context
    """

    def __init__(self, context: Context) -> None:
        protocol = replace(context.protocol, timing="shared")
        clock = Clock(protocol.seed)
        self._dataset = context.dataset
        self._features = FeatureSource(context.methods, protocol, clock)
        self._stages = PairStages(context.methods, protocol, context.dataset.geometry, clock)
        self._judge = RightMatches(context)
        self._pair: Pair | None = None

    def draw(self, pair_index: int, combination: Combination) -> DrawnMatches | str:
        """The matches, or why there are none; features are shared within a pair.

        Parameters
        ----------
        pair_index : int
            The pair's number in the dataset.
        combination : Combination
        """
        pair = self._dataset.pair(pair_index)
        if pair is not self._pair:
            self._features.trim()
            self._pair = pair
        try:
            return self._match(pair, combination)
        except StageError as failure:
            return failure.message or f"{failure.status.replace('_', ' ')} on this pair"

    def _detect(self, combination: Combination, name: str) -> ImageFeatures:
        return unless_failed(
            self._features.detected(self._dataset.image(name), combination.detector)
        )

    def _describe(self, combination: Combination, found: ImageFeatures) -> Features:
        if not len(found.keypoints):
            raise StageError("no_keypoints", None)
        features = self._features.described(found, combination).features
        if not len(features):
            raise StageError("no_descriptors", None)
        return features

    def _match(self, pair: Pair, combination: Combination) -> DrawnMatches:
        images = "this pair"
        seen = (self._detect(combination, pair.image_1), self._detect(combination, pair.image_2))
        if combination.guided and not all(len(image.keypoints) for image in seen):
            raise StageError("no_keypoints", None)
        if combination.of_pairs:
            whole, _ = self._stages.match_images(combination, seen, images)
            (first, second), matches = whole.features, whole.matches
        else:
            first, second = (self._describe(combination, image) for image in seen)
            matches, _ = self._stages.match(combination, (first, second), images)
        points, order = matched_points(first, second, matches)
        verdict = self._stages.verify(combination, points, order, images)
        right, judge = self._judge.judged(pair, *points)
        return DrawnMatches(
            keypoints_1=first.keypoints.xy,
            keypoints_2=second.keypoints.xy,
            matches=np.hstack(points),
            inliers=np.zeros(len(matches), bool) if verdict is None else verdict.model.inliers,
            verified=verdict is not None,
            right=right,
            judge=judge,
        )
