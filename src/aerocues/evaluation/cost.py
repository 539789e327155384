"""A rough estimate of what a unit costs: to begin with the costliest and to tell the time left."""

from __future__ import annotations

from collections.abc import Sequence

from aerocues.methods.combination import Combination
from aerocues.methods.registry import Methods

TYPICAL_MEGAPIXELS = 0.6
FLANN_SECONDS_PER_KEYPOINT = 1e-4


def match_seconds(methods: Methods, combination: Combination, keypoints: float) -> float:
    """CPU seconds to match images with so many keypoints.

    Measured on OpenCV's matchers: nanoseconds a pair of descriptors grow with their length.
    """
    if combination.matcher != "BF":
        return FLANN_SECONDS_PER_KEYPOINT * keypoints
    row = methods.descriptors[combination.descriptor]
    per_column = 0.17 if row.dtype == "float32" else 0.88 if combination.norm == "L2" else 0.15
    return keypoints * keypoints * (2.0 + per_column * row.columns) * 1e-9


def estimate_pair_seconds(
    methods: Methods, detector: str, combinations: Sequence[Combination]
) -> float:
    """CPU seconds to evaluate combinations of one detector on one pair of typical images."""
    row = methods.detectors[detector]
    keypoints = row.keypoints_per_megapixel * TYPICAL_MEGAPIXELS
    descriptors = {combination.descriptor for combination in combinations}
    describing = sum(methods.descriptors[name].microseconds_per_keypoint for name in descriptors)
    return (
        row.seconds_per_megapixel * TYPICAL_MEGAPIXELS
        + describing * 1e-6 * keypoints
        + sum(match_seconds(methods, combination, keypoints) for combination in combinations)
    )
