"""What is measured on two described images: match, verify, compare with the truth."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import cv2

from aerocues.datasets.dataset import Pair
from aerocues.evaluation import ground_truth
from aerocues.evaluation.clock import Clock, StageTime
from aerocues.evaluation.features import Described, ImageFeatures, run_stage
from aerocues.evaluation.metrics import Row
from aerocues.evaluation.schema import PIXEL_THRESHOLDS
from aerocues.evaluation.unit import Context, StageCall
from aerocues.evaluation.verification import (
    chance_inliers,
    estimate_homography,
    find_fundamental,
    magsac_parameters,
    read_model,
)
from aerocues.methods.arrays import Float32Array, Matches
from aerocues.methods.combination import Combination
from aerocues.methods.making import MatcherStage, make_matcher

Announce = Callable[[StageCall], None]


@dataclass(frozen=True)
class TwoViews:
    """The two images of a pair under one detector and descriptor."""

    pair: Pair
    images: tuple[ImageFeatures, ImageFeatures]
    described: tuple[Described, Described]


class TwoViewMeasurement:
    """Fills the rows of pairs; matchers are made once and kept."""

    def __init__(self, context: Context, clock: Clock, announce: Announce) -> None:
        self._context = context
        self._clock = clock
        self._announce = announce
        self._matchers: dict[tuple[str, str], MatcherStage] = {}
        self._magsac = magsac_parameters(context.protocol.verification)
        self._repeatabilities: dict[tuple[bytes, bytes], float | None] = {}

    def begin_pair(self) -> None:
        """Forget what was remembered of the pair before."""
        self._repeatabilities.clear()

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
        points_1 = first.keypoints.xy[matches.indices[:, 0]]
        points_2 = second.keypoints.xy[matches.indices[:, 1]]
        status = self._verify(row, views.pair, combination, points_1, points_2)
        if views.pair.homography is not None:
            self._compare_with_truth(row, views, points_1, points_2)
        return status

    def _match(self, row: Row, views: TwoViews, combination: Combination) -> Matches:
        self._announce(_call("match", views.pair, combination))
        what = f"{combination} matching {views.pair.image_1} and {views.pair.image_2}"
        kind = (combination.matcher, combination.norm)
        if kind not in self._matchers:
            self._matchers[kind] = run_stage(
                what, lambda: make_matcher(self._context.methods, *kind)
            )
        matcher = self._matchers[kind]
        first, second = (described.features for described in views.described)
        cv2.setRNGSeed(self._context.protocol.seed)
        raw, time = run_stage(what, lambda: self._clock.time(lambda: matcher.call(first, second)))
        record_time(row, "match_seconds", time)
        return run_stage(what, lambda: matcher.read(raw))

    def _verify(
        self,
        row: Row,
        pair: Pair,
        combination: Combination,
        points_1: Float32Array,
        points_2: Float32Array,
    ) -> str:
        protocol = self._context.protocol
        count = len(points_1)
        if count < protocol.verification.minimum_matches:
            return "too_few_matches"
        self._announce(_call("verify", pair, combination))
        what = f"verifying {combination} on {pair.image_1} and {pair.image_2}"
        cv2.setRNGSeed(protocol.seed)
        raw, time = run_stage(
            what,
            lambda: self._clock.time(lambda: find_fundamental(points_1, points_2, self._magsac)),
        )
        record_time(row, "verify_seconds", time)
        model = read_model(raw, count)
        row["inliers"] = model.count
        if protocol.chance is not None:
            chance = protocol.chance
            row["chance_inliers"], row["chance_inliers_max"] = run_stage(
                what,
                lambda: chance_inliers(
                    points_1, points_2, protocol.verification, chance, protocol.seed
                ),
            )
            if (
                model.matrix is not None
                and model.count <= chance.factor * row["chance_inliers_max"]
            ):
                return "chance"
        return "no_model" if model.matrix is None else "ok"

    def _compare_with_truth(
        self,
        row: Row,
        views: TwoViews,
        points_1: Float32Array,
        points_2: Float32Array,
    ) -> None:
        truth = views.pair.homography
        assert truth is not None
        errors = ground_truth.transfer_errors(points_1, points_2, truth)
        for threshold in PIXEL_THRESHOLDS:
            correct = int((errors <= threshold).sum())
            if len(errors):
                row[f"gt_precision@{threshold}"] = correct / len(errors)
            row[f"gt_matching_score@{threshold}"] = correct / row["keypoints_1"]
        pixels_1, pixels_2 = (image.pixels for image in views.images)
        xy_1, xy_2 = (described.features.keypoints.xy for described in views.described)
        same = (xy_1.tobytes(), xy_2.tobytes())
        if same not in self._repeatabilities:
            self._repeatabilities[same] = ground_truth.repeatability(
                xy_1, xy_2, truth, pixels_1, pixels_2
            )
        row["gt_repeatability"] = self._repeatabilities[same]
        model = run_stage(
            "estimating a homography",
            lambda: estimate_homography(points_1, points_2, self._context.protocol.verification),
        )
        row["homography_inliers"] = model.count
        error = ground_truth.corner_error(model.matrix, truth, pixels_1)
        row["homography_error"] = error
        for threshold in PIXEL_THRESHOLDS:
            row[f"homography_auc@{threshold}"] = ground_truth.area_under_curve(error, threshold)


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
    """Enter the wall and CPU seconds of a stage, and its rise of memory where it is known."""
    row[name], row[f"{name}_cpu"] = time.wall, time.cpu
    if time.peak_memory is not None:
        row["peak_memory_mb"] = max(row["peak_memory_mb"] or 0.0, time.peak_memory)
