"""Keypoints and matches of one combination on one pair, computed again as they were measured."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.dataset import Pair
from aerocues.evaluation.unit import Context
from aerocues.methods.arrays import Features
from aerocues.methods.combination import Combination
from aerocues.methods.making import make_descriptor, make_detector, make_matcher
from aerocues.pipeline.clock import Clock
from aerocues.pipeline.features import FeatureExtractor, ImageFeatures, StageError, run_stage
from aerocues.pipeline.verification import Verifiers

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
    """

    keypoints_1: Floats
    keypoints_2: Floats
    matches: Floats
    inliers: NDArray[np.bool_]
    verified: bool

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
        cv2.setNumThreads(1)
        self._context = context
        self._seed = context.protocol.seed
        clock = Clock(self._seed)
        self._extractor = FeatureExtractor(clock, self._seed, context.protocol.limit)
        self._verifiers = Verifiers(context.protocol, context.dataset.geometry, clock)
        self._pair: Pair | None = None
        self._images: dict[tuple[str, str], ImageFeatures] = {}

    def draw(self, pair_index: int, combination: Combination) -> DrawnMatches | str:
        """The matches, or why there are none; features are shared within a pair.

        Parameters
        ----------
        pair_index : int
            The pair's number in the dataset.
        combination : Combination
        """
        pair = self._context.dataset.pair(pair_index)
        if pair is not self._pair:
            self._images.clear()
            self._pair = pair
        try:
            first = self._describe(combination, pair.image_1)
            second = self._describe(combination, pair.image_2)
            return self._match(combination, first, second)
        except StageError as failure:
            return failure.message or f"{failure.status.replace('_', ' ')} on this pair"

    def _describe(self, combination: Combination, image_name: str) -> Features:
        methods = self._context.methods
        key = (combination.detector, image_name)
        if key not in self._images:
            detector = run_stage(
                combination.detector, lambda: make_detector(methods, combination.detector)
            )
            image = self._context.dataset.image(image_name)
            self._images[key] = self._extractor.detect(image, combination.detector, detector)
        name = combination.descriptor
        descriptor = run_stage(name, lambda: make_descriptor(methods, name, combination.detector))
        if not len(self._images[key].keypoints):
            raise StageError("no_keypoints", None)
        return self._extractor.describe(self._images[key], name, name, descriptor).features

    def _match(self, combination: Combination, first: Features, second: Features) -> DrawnMatches:
        what = str(combination)
        if not len(first) or not len(second):
            raise StageError("no_descriptors", None)
        matcher = run_stage(
            what,
            lambda: make_matcher(self._context.methods, combination.matcher, combination.norm),
        )
        cv2.setRNGSeed(self._seed)
        found = run_stage(what, lambda: matcher.read(matcher.call(first, second)))
        points_1 = first.keypoints.xy[found.indices[:, 0]]
        points_2 = second.keypoints.xy[found.indices[:, 1]]
        inliers: Any = np.zeros(len(found), bool)
        verified = len(found) >= self._context.protocol.verification.minimum_matches
        if verified:
            order = np.argsort(found.distance, kind="stable")
            verifier = self._verifiers.of(combination)
            verdict = run_stage(what, lambda: verifier.verify(points_1, points_2, order))
            inliers = verdict.model.inliers
        return DrawnMatches(
            keypoints_1=first.keypoints.xy,
            keypoints_2=second.keypoints.xy,
            matches=np.hstack([points_1, points_2]),
            inliers=inliers,
            verified=verified,
        )
