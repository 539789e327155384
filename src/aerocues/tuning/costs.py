"""Predicted cost of measuring a combination on a pair: from tables first, then from rows."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from aerocues.evaluation.cost import TYPICAL_MEGAPIXELS, match_seconds
from aerocues.methods.combination import Combination
from aerocues.methods.registry import Methods
from aerocues.pipeline.pair_stages import BRUTE_FORCE
from aerocues.results.metrics import Row
from aerocues.tuning.scales import Array

# Measured: exact search and timing of a sample take this share of the brute-force time, and at
# least this many seconds.
EXACT_SHARE = {"HAM": 0.05, "L2": 0.13}
EXACT_SECONDS = 0.01


class _Mean:
    def __init__(self) -> None:
        self._sum, self._count = 0.0, 0

    def add(self, value: float) -> None:
        self._sum += value
        self._count += 1

    def __call__(self, otherwise: float) -> float:
        return self._sum / self._count if self._count else otherwise


class Costs:
    """Predicts CPU seconds; each measured row improves the prediction.

    Parameters
    ----------
    methods : Methods
    combinations : sequence of Combination
    """

    def __init__(self, methods: Methods, combinations: Sequence[Combination]) -> None:
        self._methods, self._combinations = methods, combinations
        self._keypoints: dict[str, _Mean] = defaultdict(_Mean)
        self._detecting: dict[str, _Mean] = defaultdict(_Mean)
        self._describing: dict[str, _Mean] = defaultdict(_Mean)
        self._matching: dict[str, _Mean] = defaultdict(_Mean)

    def learn(self, row: Row) -> None:
        """Update the prediction with a measured row."""
        detector, both = str(row["detector"]), f"{row['detector']}-{row['descriptor']}"
        name = f"{both}-{row['norm']}-{row['matcher']}"
        keypoints, detecting = row["keypoints_1"], row["detect_seconds_1_cpu"]
        describing, matching = row["describe_seconds_1_cpu"], row["match_seconds_cpu"]
        if isinstance(keypoints, int):
            self._keypoints[detector].add(float(keypoints))
        for known, mean in (
            (detecting, self._detecting[detector]),
            (describing, self._describing[both]),
            (matching, self._matching[name]),
        ):
            if isinstance(known, float):
                mean.add(known)

    def predicted(self) -> Array:
        """(A,) seconds of each combination on a pair without stored features."""
        return np.array([self._predict(each) for each in self._combinations])

    def _predict(self, combination: Combination) -> float:
        detector = self._methods.detectors[combination.detector]
        descriptor = self._methods.descriptors[combination.descriptor]
        keypoints = self._keypoints[combination.detector](
            detector.keypoints_per_megapixel * TYPICAL_MEGAPIXELS
        )
        detecting = self._detecting[combination.detector](
            detector.seconds_per_megapixel * TYPICAL_MEGAPIXELS
        )
        both = f"{combination.detector}-{combination.descriptor}"
        describing = self._describing[both](1e-6 * descriptor.microseconds_per_keypoint * keypoints)
        matching = self._matching[str(combination)](
            match_seconds(self._methods, combination, keypoints)
        )
        if combination.matcher == BRUTE_FORCE:
            matching = min(matching, EXACT_SECONDS + EXACT_SHARE[combination.norm] * matching)
        return 2.0 * (detecting + describing) + matching
