"""Rough cost of a unit, to start with the most expensive ones and to estimate the time left."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from aerocues.methods.combination import Combination
from aerocues.methods.registry import Methods

TYPICAL_MEGAPIXELS = 0.6
FLANN_SECONDS_PER_KEYPOINT = 1e-4
BY_BRUTE_FORCE = frozenset(("BF", "GMS", "RATIO"))
SHORTEST_UNIT = 1.0
"""CPU seconds per image below which work is not divided."""


def match_seconds(methods: Methods, combination: Combination, keypoints: float) -> float:
    """CPU seconds to match images with these numbers of keypoints.

    Measured with OpenCV's matchers: the time per pair of descriptors grows with their length.
    """
    if combination.matcher not in BY_BRUTE_FORCE:
        return FLANN_SECONDS_PER_KEYPOINT * keypoints
    row = methods.descriptors[combination.descriptor]
    per_column = 0.17 if row.dtype == "float32" else 0.88 if combination.norm == "L2" else 0.15
    return keypoints * keypoints * (2.0 + per_column * row.columns) * 1e-9


# Detection may be repeated for a descriptor that takes this many times as long as detection.
WORTH_DETECTING_AGAIN = 20.0


def describe_seconds(methods: Methods, detector: str, descriptor: str) -> float:
    """CPU seconds to describe the keypoints of a typical image."""
    keypoints = methods.detectors[detector].keypoints_per_megapixel * TYPICAL_MEGAPIXELS
    return methods.descriptors[descriptor].microseconds_per_keypoint * 1e-6 * keypoints


def costly_descriptors(methods: Methods, detector: str, descriptors: Iterable[str]) -> list[str]:
    """Descriptors that get their own units: VGG and BOOST on many keypoints."""
    detecting = methods.detectors[detector].seconds_per_megapixel * TYPICAL_MEGAPIXELS
    least = max(WORTH_DETECTING_AGAIN * detecting, SHORTEST_UNIT)
    return [name for name in descriptors if describe_seconds(methods, detector, name) >= least]


def estimate_pair_seconds(
    methods: Methods, detector: str, combinations: Sequence[Combination]
) -> float:
    """CPU seconds to evaluate combinations of one detector on one pair of typical images."""
    row = methods.detectors[detector]
    keypoints = row.keypoints_per_megapixel * TYPICAL_MEGAPIXELS
    descriptors = {combination.descriptor for combination in combinations}
    describing = sum(describe_seconds(methods, detector, name) for name in descriptors)
    return (
        row.seconds_per_megapixel * TYPICAL_MEGAPIXELS
        + describing
        + sum(match_seconds(methods, combination, keypoints) for combination in combinations)
    )
