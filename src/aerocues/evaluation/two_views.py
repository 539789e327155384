"""What is measured on two described images: match, verify, compare with the truth."""

from __future__ import annotations

from aerocues.datasets.dataset import Pair
from aerocues.evaluation.reference_comparison import ReferenceComparison
from aerocues.evaluation.truth_comparison import Matched, TruthComparison, TwoViews
from aerocues.evaluation.unit import Context
from aerocues.methods.arrays import Matches
from aerocues.methods.combination import Combination
from aerocues.pipeline.clock import NO_TIME, Clock, StageTime
from aerocues.pipeline.feature_source import Announce
from aerocues.pipeline.features import Described, ImageFeatures
from aerocues.pipeline.pair_stages import PairStages, matched_points
from aerocues.pipeline.reference_source import ReferenceSource
from aerocues.results.metrics import STAGES_OF_IMAGES, Row


class TwoViewMeasurement:
    """Fills the rows of pairs."""

    def __init__(self, context: Context, clock: Clock, announce: Announce) -> None:
        self._stages = PairStages(
            context.methods, context.protocol, context.dataset.geometry, clock, announce
        )
        self._truth = TruthComparison(context.dataset)
        self._reference: ReferenceComparison | None = None
        if context.protocol.chance:
            source = ReferenceSource(context.references, announce)
            share = context.protocol.chance.right_share
            self._reference = ReferenceComparison(context.dataset, source, share)

    def begin_pair(self, pair: Pair) -> None:
        """Get ready for another pair."""
        self._truth.begin_pair()
        if self._reference:
            self._reference.begin_pair(pair)

    def begin_row(self, row: Row) -> None:
        """Enter what is the same in all rows of the pair."""
        if self._reference:
            self._reference.describe_pair(row)

    def measure(self, row: Row, views: TwoViews, combination: Combination) -> str:
        """Match, verify and measure; the status. The row keeps what was found until a failure."""
        first, second = (described.features for described in views.described)
        row["keypoints_1"], row["keypoints_2"] = len(first), len(second)
        for side, described in zip((1, 2), views.described, strict=True):
            record_time(row, f"describe_seconds_{side}", described.time)
        row["descriptor_bytes"] = first.descriptors.shape[1] * first.descriptors.itemsize
        if not len(first) or not len(second):
            return "no_descriptors"
        names, number = f"{views.pair.image_1} and {views.pair.image_2}", views.pair.index
        matches, time = self._stages.match(combination, (first, second), names, number)
        record_time(row, "match_seconds", time)
        return self._judge(row, views, matches, combination)

    def measure_images(
        self,
        row: Row,
        pair: Pair,
        images: tuple[ImageFeatures, ImageFeatures],
        combination: Combination,
    ) -> str:
        """As `measure`, of a pair matcher: nothing is described, or even detected, before."""
        for stage in STAGES_OF_IMAGES[combination.guided :]:
            for side in (1, 2):
                record_time(row, f"{stage}_seconds_{side}", NO_TIME)
        names = f"{pair.image_1} and {pair.image_2}"
        found, time = self._stages.match_images(combination, images, names, pair.index)
        record_time(row, "match_seconds", time)
        first, second = (Described(features, NO_TIME) for features in found.features)
        row["keypoints_1"], row["keypoints_2"] = len(first.features), len(second.features)
        row["descriptor_bytes"] = 0
        return self._judge(row, TwoViews(pair, images, (first, second)), found.matches, combination)

    def _judge(self, row: Row, views: TwoViews, matches: Matches, combination: Combination) -> str:
        """Verify matches and compare them with what is known; the status."""
        names, number = f"{views.pair.image_1} and {views.pair.image_2}", views.pair.index
        first, second = (described.features for described in views.described)
        row["matches"] = len(matches)
        points, order = matched_points(first, second, matches)
        verdict = self._stages.verify(combination, points, order, names, number)
        status = "too_few_matches"
        if verdict is not None:
            record_time(row, "verify_seconds", verdict.time)
            row["inliers"] = verdict.model.count
            row["sampling"] = verdict.sampling
            row["chance_inliers"] = verdict.chance_mean
            row["chance_inliers_max"] = verdict.chance_max
            status = verdict.status
        found = Matched(*points, order)
        self._truth.compare(row, views, found, self._stages.verifier(combination))
        model = verdict.model if verdict else None
        if self._reference and self._reference.compare(row, views, found, model):
            return "chance"
        return status


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
