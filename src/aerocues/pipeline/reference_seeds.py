"""Seeds of a reference: matches of several methods that one epipolar geometry explains."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.dataset import Pixels
from aerocues.methods.arrays import Features, Float32Array
from aerocues.methods.combination import Combination
from aerocues.methods.compatibility import why_unavailable
from aerocues.methods.exact.availability import why_not_exact
from aerocues.methods.making import MatcherStage, make_descriptor, make_detector, make_matcher
from aerocues.methods.registry import Methods, opencv_methods
from aerocues.methods.strongest import KeypointLimit
from aerocues.pipeline.features import on_valid_pixels
from aerocues.pipeline.protocol import Verification
from aerocues.pipeline.verification import estimate_fundamental_matrix, magsac_parameters

# Two that turn with the image, and corners, where those find little. Which ones hardly matters:
# with one of them alone the precisions of combinations are in the same order (Spearman .999).
SEED_METHODS = (("SIFT", "SIFT", "L2"), ("AKAZE", "AKAZE", "HAM"), ("GFTT", "DAISY", "L2"))
LIMIT = KeypointLimit(3000)
SEED = 0
FEW_DISTANCES = 400_000
"""OpenCV's brute force finds the same matches of so many sooner than compiled code is loaded."""

CLOSE, CONFIDENCE = 1.5, 0.999
ITERATIONS, SHUFFLED_ITERATIONS = 5000, 1000
FEWEST_SEEDS, FACTOR_OF_CHANCE, SHUFFLES = 30, 1.5, 5


class NoReferenceError(Exception):
    """Two images have no reference; the message is the reason."""


@dataclass(frozen=True, eq=False)
class Seeds:
    """Points that were matched: (K, 2) float32 pixels of each image."""

    points_1: Float32Array
    points_2: Float32Array

    def __len__(self) -> int:
        return len(self.points_1)

    def take(self, which: NDArray[Any]) -> Seeds:
        """Those of a mask or of indices."""
        return Seeds(self.points_1[which], self.points_2[which])

    def close(self, iterations: int = ITERATIONS) -> NDArray[np.bool_]:
        """Which ones (K,) lie within `CLOSE` pixels of the lines of one fundamental matrix."""
        settings = Verification(CLOSE, CONFIDENCE, iterations)
        parameters = magsac_parameters(settings, seed=SEED)
        return estimate_fundamental_matrix(self.points_1, self.points_2, parameters).inliers

    def shuffled(self, number: int) -> Seeds:
        """The same points, put together at random."""
        order = np.random.default_rng((SEED, number)).permutation(len(self))
        return Seeds(self.points_1, self.points_2[order])


class SeedMethods:
    """The methods that seeds are found with; they are made once."""

    def __init__(self) -> None:
        methods = LIMIT.limited(opencv_methods())
        chosen = [Combination(*names, "BF") for names in SEED_METHODS]
        self._kinds = [_Kind(c, methods) for c in chosen if not why_unavailable(c, methods)]

    def features(self, pixels: Pixels) -> tuple[Features, ...]:
        """What each method finds in an image; nothing on what is not valid.

        Raises
        ------
        cv2.error
            If OpenCV refuses the image.
        """
        return tuple(kind.features(pixels) for kind in self._kinds)

    def seeds(self, first: tuple[Features, ...], second: tuple[Features, ...]) -> Seeds:
        """Matches that one geometry explains, of the methods whose matches beat chance.

        Raises
        ------
        NoReferenceError
            If there are too few.
        """
        of_kinds = zip(self._kinds, first, second, strict=True)
        found = [_beyond_chance(kind.matched(one, other)) for kind, one, other in of_kinds]
        if not any(map(len, found)):
            raise NoReferenceError("the matches of SIFT, AKAZE and GFTT-DAISY do not beat chance")
        pooled = Seeds(
            np.concatenate([seeds.points_1 for seeds in found]),
            np.concatenate([seeds.points_2 for seeds in found]),
        )
        agreeing = pooled.take(pooled.close())
        if len(agreeing) < FEWEST_SEEDS:
            raise NoReferenceError("the matches of SIFT, AKAZE and GFTT-DAISY disagree")
        return agreeing


class _Kind:
    """One method that seeds are found with."""

    def __init__(self, combination: Combination, methods: Methods) -> None:
        self._detector = make_detector(methods, combination.detector)
        self._descriptor = make_descriptor(methods, combination.descriptor, combination.detector)
        self._matcher = make_matcher(methods, combination.matcher, combination.norm)
        self._make_exact = partial(make_matcher, methods, "EXACT", combination.norm)

    @cached_property
    def _exact(self) -> MatcherStage:
        return self._make_exact()

    def features(self, pixels: Pixels) -> Features:
        cv2.setRNGSeed(SEED)
        found = self._detector.read(self._detector.call(pixels.bgr))
        kept = LIMIT.keep(on_valid_pixels(found, pixels.valid), SEED)
        if not len(kept):
            return Features(kept, np.empty((0, 1), np.uint8))
        cv2.setRNGSeed(SEED)
        raw = self._descriptor.call(pixels.bgr, self._descriptor.prepare(kept, pixels.bgr))
        return self._descriptor.read(raw)

    def matched(self, first: Features, second: Features) -> Seeds:
        if not len(first) or not len(second):
            return Seeds(first.keypoints.xy[:0], second.keypoints.xy[:0])
        few = len(first) * len(second) <= FEW_DISTANCES or why_not_exact()
        matcher = self._matcher if few else self._exact
        matches = matcher.read(matcher.call(first, second))
        rows_1, rows_2 = matches.indices.T
        return Seeds(first.keypoints.xy[rows_1], second.keypoints.xy[rows_2])


def _beyond_chance(matched: Seeds) -> Seeds:
    """The matches that one geometry explains; none where shuffled ones give nearly as many."""
    if len(matched) < FEWEST_SEEDS:
        return matched.take(np.zeros(0, np.intp))
    close = matched.close()
    shuffled = (matched.shuffled(number) for number in range(SHUFFLES))
    chance = max(int(each.close(SHUFFLED_ITERATIONS).sum()) for each in shuffled)
    enough = close.sum() >= max(FEWEST_SEEDS, FACTOR_OF_CHANCE * chance)
    return matched.take(close if enough else np.zeros(0, np.intp))
