"""What is measured on two described images: match, verify, compare with the truth."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from aerocues.datasets.dataset import Pair
from aerocues.evaluation.truth_comparison import Matched, TruthComparison, TwoViews
from aerocues.evaluation.unit import Context
from aerocues.methods.arrays import Features, Matches
from aerocues.methods.combination import Combination
from aerocues.methods.making import MatcherStage, make_matcher
from aerocues.pipeline.brute_force_time import SampledBruteForce
from aerocues.pipeline.clock import Clock, StageTime
from aerocues.pipeline.features import run_stage, warm_up
from aerocues.pipeline.verification import Verifiers
from aerocues.processes.call import StageCall
from aerocues.results.metrics import Row

BRUTE_FORCE = "BF"
WARM_UP_FEATURES = 32
Announce = Callable[[StageCall], None]


class TwoViewMeasurement:
    """Fills the rows of pairs; matchers are made once and kept."""

    def __init__(self, context: Context, clock: Clock, announce: Announce) -> None:
        self._context = context
        self._clock = clock
        self._announce = announce
        self._matchers: dict[tuple[str, str], MatcherStage] = {}
        self._verifiers = Verifiers(context.protocol, context.dataset.geometry, clock)
        self._truth = TruthComparison(context.dataset)

    def begin_pair(self) -> None:
        """Forget what was remembered of the pair before."""
        self._truth.begin_pair()

    def measure(self, row: Row, views: TwoViews, combination: Combination) -> str:
        """Match, verify and measure; the status. The row keeps what was found until a failure."""
        first, second = (described.features for described in views.described)
        row["keypoints_1"], row["keypoints_2"] = len(first), len(second)
        for side, described in zip((1, 2), views.described, strict=True):
            record_time(row, f"describe_seconds_{side}", described.time)
        row["descriptor_bytes"] = first.descriptors.shape[1] * first.descriptors.itemsize
        if not len(first) or not len(second):
            return "no_descriptors"
        matches = self._match(row, views, combination)
        row["matches"] = len(matches)
        found = Matched(
            first.keypoints.xy[matches.indices[:, 0]],
            second.keypoints.xy[matches.indices[:, 1]],
            np.argsort(matches.distance, kind="stable"),
        )
        status = self._verify(row, views, combination, found)
        self._truth.compare(row, views, found, self._verifiers.of(combination))
        return status

    def _match(self, row: Row, views: TwoViews, combination: Combination) -> Matches:
        self._announce(_call("match", views.pair, combination))
        what = f"{combination} matching {views.pair.image_1} and {views.pair.image_2}"
        kind = (combination.matcher, combination.norm)
        first, second = (described.features for described in views.described)
        if kind not in self._matchers:
            made = run_stage(what, lambda: make_matcher(self._context.methods, *kind))
            self._matchers[kind] = made
            few = [_first_ones(features) for features in (first, second)]
            warm_up(lambda: made.call(*few))
        matcher = self._matchers[kind]
        if combination.matcher == BRUTE_FORCE and self._context.protocol.timing == "estimated":
            sampled = SampledBruteForce(matcher, combination.norm, self._clock)
            matches, time = run_stage(what, lambda: sampled.match(first, second))
            record_time(row, "match_seconds", time)
            return matches
        raw, time = run_stage(what, lambda: self._clock.time(lambda: matcher.call(first, second)))
        record_time(row, "match_seconds", time)
        return run_stage(what, lambda: matcher.read(raw))

    def _verify(self, row: Row, views: TwoViews, combination: Combination, found: Matched) -> str:
        if len(found.points_1) < self._context.protocol.verification.minimum_matches:
            return "too_few_matches"
        self._announce(_call("verify", views.pair, combination))
        what = f"verifying {combination} on {views.pair.image_1} and {views.pair.image_2}"
        verifier = self._verifiers.of(combination)
        verdict = run_stage(
            what, lambda: verifier.verify(found.points_1, found.points_2, found.order)
        )
        record_time(row, "verify_seconds", verdict.time)
        row["inliers"] = verdict.model.count
        row["sampling"] = verdict.sampling
        row["chance_inliers"] = verdict.chance_mean
        row["chance_inliers_max"] = verdict.chance_max
        if verdict.model.matrix is None:
            return "no_model"
        return "ok" if verdict.passed else "chance"


def _first_ones(features: Features) -> Features:
    kept = np.arange(min(len(features), WARM_UP_FEATURES))
    return Features(features.keypoints.take(kept), features.descriptors[kept])


def _call(stage: str, pair: Pair, combination: Combination) -> StageCall:
    images = f"{pair.image_1} and {pair.image_2}"
    return StageCall(
        stage,
        pair.index,
        images,
        combination.detector,
        combination.descriptor,
        str(combination),
    )


def record_time(row: Row, name: str, time: StageTime) -> None:
    """Enter the wall and CPU seconds of a stage, and what else is known of its calls."""
    row[name], row[f"{name}_cpu"] = time.wall, time.cpu
    if time.peak_memory is not None:
        row["peak_memory_mb"] = max(row["peak_memory_mb"] or 0.0, time.peak_memory)
    if time.repeats is None:
        return
    row["timing_repeats"] = min(row["timing_repeats"] or time.repeats, time.repeats)
    for column, value in (("timing_spread", time.spread), ("wall_over_cpu", time.wall_over_cpu)):
        if value is not None:
            row[column] = max(row[column] or 0.0, value)
