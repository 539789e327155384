"""Matches of two images and their verified geometry, under any combination."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.dataset import Geometry
from aerocues.methods.arrays import Features, Float32Array, Matches
from aerocues.methods.combination import Combination
from aerocues.methods.making import MatcherStage, make_matcher, make_pair_matcher
from aerocues.methods.pair_matching import ArrayPairMatcher
from aerocues.methods.registry import Methods
from aerocues.pipeline.brute_force_time import SampledBruteForce
from aerocues.pipeline.clock import Clock, StageTime
from aerocues.pipeline.feature_source import Announce, silent
from aerocues.pipeline.features import ImageFeatures, as_seen, centre, run_stage, warm_up
from aerocues.pipeline.guiding import guided_matches
from aerocues.pipeline.protocol import MeasurementProtocol
from aerocues.pipeline.verification import IndexArray, Verdict, Verifier
from aerocues.pipeline.whole_images import MatchedPair, matched_pair, undescribed
from aerocues.processes.call import NO_PAIR, StageCall

BRUTE_FORCE = "BF"
WARM_UP_FEATURES = 32


class PairStages:
    """Matches and verifies; matchers and verifiers are made once and kept.

    Parameters
    ----------
    methods : Methods
    protocol : MeasurementProtocol
    geometry : {"homography", "epipolar"}
        Of the images.
    clock : Clock
    announce : callable
        Called with each stage call before it begins.
    """

    def __init__(
        self,
        methods: Methods,
        protocol: MeasurementProtocol,
        geometry: Geometry,
        clock: Clock,
        announce: Announce = silent,
    ) -> None:
        self._methods = methods
        self._protocol = protocol
        self._geometry = geometry
        self._clock = clock
        self._announce = announce
        self._matchers: dict[tuple[str, str], MatcherStage] = {}
        self._pair_matchers: dict[str, ArrayPairMatcher] = {}
        self._verifiers: dict[float, Verifier] = {}

    def match(
        self,
        combination: Combination,
        features: tuple[Features, Features],
        images: str,
        pair: int = NO_PAIR,
    ) -> tuple[Matches, StageTime]:
        """Mutual matches of two images, and the time of the call.

        Parameters
        ----------
        combination : Combination
        features : tuple of Features
            Of the first and of the second image; none may be empty.
        images : str
            What the images are called, for `announce` and for messages.
        pair : int
            The pair that is worked on, for `announce`.

        Raises
        ------
        StageError
            If the matcher fails.
        """
        self._announce(stage_call("match", combination, images, pair))
        what = f"{combination} matching {images}"
        features = as_seen(features[0]), as_seen(features[1])
        matcher = self._matcher(combination, features, what)
        if combination.matcher == BRUTE_FORCE and self._protocol.timing == "estimated":
            sampled = SampledBruteForce(matcher, combination.norm, self._clock)
            return run_stage(what, lambda: sampled.match(*features))
        raw, time = run_stage(what, lambda: self._clock.time(lambda: matcher.call(*features)))
        return run_stage(what, lambda: matcher.read(raw)), time

    def match_images(
        self,
        combination: Combination,
        images: tuple[ImageFeatures, ImageFeatures],
        names: str,
        pair: int = NO_PAIR,
    ) -> tuple[MatchedPair, StageTime]:
        """What a pair matcher finds in two images, and the time of the call.

        Parameters
        ----------
        combination : Combination
            Of a pair matcher.
        images : tuple of ImageFeatures
            The first and the second image; their keypoints count where it guides them.
        names, pair
            As `images` and `pair` in `match`.

        Raises
        ------
        StageError
            If the pair matcher fails.
        """
        self._announce(stage_call("match", combination, names, pair))
        what = f"{combination.matcher} matching {names}"
        first, second = (image.seen for image in images)
        matcher = self._pair_matcher(combination.matcher, (first, second), what)
        if combination.guided:
            return run_stage(what, lambda: self._guided(matcher, images))
        raw, time = run_stage(what, lambda: self._clock.time(lambda: matcher.call(first, second)))
        found = run_stage(what, lambda: matcher.read(raw))
        return matched_pair(found, images, self._protocol.limit, self._protocol.seed), time

    def verify(
        self,
        combination: Combination,
        points: tuple[Float32Array, Float32Array],
        order: IndexArray,
        images: str,
        pair: int = NO_PAIR,
    ) -> Verdict | None:
        """The model that matches agree on; None with too few matches to look for one.

        Parameters
        ----------
        combination : Combination
        points : tuple of (M, 2) float32
            Matched points of the first and of the second image, pixels.
        order : (M,) int
            The matches by descriptor distance, the smallest first.
        images, pair
            As in `match`.

        Raises
        ------
        StageError
            If OpenCV refuses the points.
        """
        if len(points[0]) < self._protocol.verification.minimum_matches:
            return None
        self._announce(stage_call("verify", combination, images, pair))
        verifier = self.verifier(combination)
        what = f"verifying {combination} on {images}"
        return run_stage(what, lambda: verifier.verify(*points, order))

    def verifier(self, combination: Combination) -> Verifier:
        """The verifier of a combination: inlier thresholds may differ."""
        threshold = self._protocol.threshold(combination)
        if threshold not in self._verifiers:
            own = self._protocol.with_threshold(threshold)
            self._verifiers[threshold] = Verifier(own, self._geometry, self._clock)
        return self._verifiers[threshold]

    def _guided(
        self, matcher: ArrayPairMatcher, images: tuple[ImageFeatures, ImageFeatures]
    ) -> tuple[MatchedPair, StageTime]:
        """Keypoints that the pair matcher guides; looking for them is part of the time."""
        one, other = images

        def call() -> Matches:
            found = matcher.read(matcher.call(one.seen, other.seen))
            return guided_matches(found, one.keypoints, other.keypoints)

        matches, time = self._clock.time(call)
        first, second = (undescribed(image.positions, image.size) for image in images)
        return MatchedPair((first, second), matches), time

    def _pair_matcher(
        self, name: str, images: tuple[NDArray[np.uint8], NDArray[np.uint8]], what: str
    ) -> ArrayPairMatcher:
        if name not in self._pair_matchers:
            made = run_stage(what, lambda: make_pair_matcher(self._methods, name))
            few = [centre(image) for image in images]
            warm_up(lambda: made.call(*few))
            self._pair_matchers[name] = made
        return self._pair_matchers[name]

    def _matcher(
        self, combination: Combination, features: tuple[Features, Features], what: str
    ) -> MatcherStage:
        kind = (combination.matcher, combination.norm)
        if kind not in self._matchers:
            made = run_stage(what, lambda: make_matcher(self._methods, *kind))
            few = [_first_ones(each) for each in features]
            warm_up(lambda: made.call(*few))
            self._matchers[kind] = made
        return self._matchers[kind]


def matched_points(
    first: Features, second: Features, matches: Matches
) -> tuple[tuple[Float32Array, Float32Array], IndexArray]:
    """The (M, 2) points of matches in both images, and the matches by descriptor distance."""
    points = (
        first.keypoints.xy[matches.indices[:, 0]],
        second.keypoints.xy[matches.indices[:, 1]],
    )
    return points, np.argsort(matches.distance, kind="stable")


def stage_call(stage: str, combination: Combination, images: str, pair: int = NO_PAIR) -> StageCall:
    """A stage of one combination, as it is announced."""
    return StageCall(
        stage, pair, images, combination.detector, combination.descriptor, str(combination)
    )


def _first_ones(features: Features) -> Features:
    return features.take(np.arange(min(len(features), WARM_UP_FEATURES)))
