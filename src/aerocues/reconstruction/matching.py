"""Features of all images and matches of all pairs under one combination."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable

import cv2
import numpy as np

from aerocues.methods.arrays import Features, Matches
from aerocues.methods.combination import Combination
from aerocues.methods.making import MatcherStage, make_descriptor, make_detector, make_matcher
from aerocues.methods.strongest import KeypointLimit
from aerocues.pipeline.clock import Clock
from aerocues.pipeline.features import FeatureExtractor, StageError, run_stage
from aerocues.processes.call import StageCall
from aerocues.reconstruction.feature_files import FeatureFiles, TimedFeatures
from aerocues.reconstruction.matched_scene import MatchedScene, PairMatches
from aerocues.reconstruction.scene import Scene

Announce = Callable[[StageCall | None], None]
HELD_IN_MEMORY = 64


def call_of(stage: str, combination: Combination, image: str) -> StageCall:
    """What the watching parent is told of a stage."""
    return StageCall(
        stage, -1, image, combination.detector, combination.descriptor, str(combination)
    )


class SceneMatcher:
    """Detects, describes and matches a scene under one combination.

    What other combinations with the same detector and descriptor left in the folder of features
    is taken from there, with the time that it took.
    """

    def __init__(self, scene: Scene, combination: Combination, announce: Announce) -> None:
        cv2.setNumThreads(1)
        self._scene = scene
        self._combination = combination
        self._announce = announce
        self._files = FeatureFiles(scene, combination)
        self._clock = Clock(scene.protocol.seed)
        limit = KeypointLimit(scene.protocol.max_keypoints)
        self._extractor = FeatureExtractor(self._clock, scene.protocol.seed, limit)
        self._held: OrderedDict[str, Features] = OrderedDict()
        self._made: tuple[object, object] | None = None

    def match(self) -> MatchedScene:
        """Features and matches; StageError where a method fails."""
        keypoints = {}
        seconds = 0.0
        for image in self._scene.dataset.images:
            found = self._features(image.name)
            keypoints[image.name] = found.features.keypoints
            seconds += found.seconds
            if not np.isfinite(found.features.keypoints.xy).all():
                raise StageError(
                    "error",
                    f"{self._combination.descriptor} describing {image.name} returned positions "
                    "that are not finite",
                )
        pairs, matching_seconds = self._match_pairs()
        return MatchedScene(keypoints, pairs, seconds, matching_seconds)

    def _features(self, name: str) -> TimedFeatures:
        found = self._files.read(name)
        if found is None:
            found = self._compute(name)
            self._files.write(name, found)
        return found

    def _compute(self, name: str) -> TimedFeatures:
        methods, combination = self._scene.methods, self._combination
        self._announce(call_of("features", combination, name))
        if self._made is None:
            self._made = (
                run_stage(
                    combination.detector, lambda: make_detector(methods, combination.detector)
                ),
                run_stage(
                    combination.descriptor,
                    lambda: make_descriptor(methods, combination.descriptor, combination.detector),
                ),
            )
        detector, descriptor = self._made
        image = self._extractor.detect(
            self._scene.dataset.image(name),
            combination.detector,
            detector,  # type: ignore[arg-type]
        )
        if not len(image.keypoints):
            row = methods.descriptors[combination.descriptor]
            nothing = np.empty((0, max(row.columns, 1)), row.dtype)
            return TimedFeatures(Features(image.keypoints, nothing), image.detect_time.cpu)
        what = f"{combination.descriptor} describing {combination.detector} keypoints of {name}"
        described = self._extractor.describe(
            image,
            combination.descriptor,
            what,
            descriptor,  # type: ignore[arg-type]
        )
        seconds = image.detect_time.cpu + described.time.cpu
        return TimedFeatures(described.features, seconds)

    def _match_pairs(self) -> tuple[dict[tuple[str, str], PairMatches], float]:
        combination, methods = self._combination, self._scene.methods
        matcher = run_stage(
            combination.matcher,
            lambda: make_matcher(methods, combination.matcher, combination.norm),
        )
        pairs = {}
        seconds = 0.0
        for pair in self._scene.dataset.pairs:
            images = f"{pair.image_1} and {pair.image_2}"
            first, second = self._held_features(pair.image_1), self._held_features(pair.image_2)
            matches = Matches()
            if len(first) and len(second):
                self._announce(call_of("matching", combination, images))
                matches, taken = self._match_pair(matcher, (first, second), images)
                seconds += taken
            pairs[pair.image_1, pair.image_2] = PairMatches(matches.indices, matches.distance)
        return pairs, seconds

    def _match_pair(
        self, matcher: MatcherStage, features: tuple[Features, Features], images: str
    ) -> tuple[Matches, float]:
        """Matches and the CPU seconds of the call alone."""
        what = f"{self._combination} matching {images}"
        cv2.setRNGSeed(self._scene.protocol.seed)
        raw, time = run_stage(what, lambda: self._clock.time(lambda: matcher.call(*features)))
        return run_stage(what, lambda: matcher.read(raw)), time.cpu

    def _held_features(self, name: str) -> Features:
        """Features from memory, where those used last are kept."""
        if name not in self._held:
            self._held[name] = self._features(name).features
        self._held.move_to_end(name)
        if len(self._held) > HELD_IN_MEMORY:
            self._held.popitem(last=False)
        return self._held[name]
