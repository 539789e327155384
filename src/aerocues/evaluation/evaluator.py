"""Evaluates a unit: detect, describe, match, verify, measure."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import cv2

from aerocues.datasets.dataset import Pair
from aerocues.evaluation import ground_truth
from aerocues.evaluation.clock import Clock, StageTime
from aerocues.evaluation.features import (
    Described,
    FeatureExtractor,
    ImageFeatures,
    StageError,
    run_stage,
)
from aerocues.evaluation.metrics import Row, add_metrics
from aerocues.evaluation.schema import PIXEL_THRESHOLDS, empty_row
from aerocues.evaluation.unit import Context, PairWork, StageCall, Unit
from aerocues.evaluation.verification import (
    chance_inliers,
    estimate_homography,
    find_fundamental,
    magsac_parameters,
    read_model,
)
from aerocues.methods.arrays import Float32Array, Matches
from aerocues.methods.combination import Combination
from aerocues.methods.making import (
    DescriptorStage,
    DetectorStage,
    MatcherStage,
    make_descriptor,
    make_detector,
    make_matcher,
)

Announce = Callable[[StageCall], None]


@dataclass(frozen=True)
class PairFeatures:
    """The two images of a pair under one detector and descriptor."""

    pair: Pair
    images: tuple[ImageFeatures, ImageFeatures]
    described: tuple[Described, Described]


def identify(row: Row, context: Context, pair: Pair, combination: Combination, key: str) -> Row:
    """Fill in what names a row and where it comes from."""
    row.update(
        dataset=context.dataset.name,
        sequence=pair.sequence,
        pair=pair.index,
        image_1=pair.image_1,
        image_2=pair.image_2,
        detector=combination.detector,
        descriptor=combination.descriptor,
        norm=combination.norm,
        matcher=combination.matcher,
        preset=context.preset,
        opencv_version=cv2.__version__,
        machine=context.machine,
        seed=context.protocol.seed,
        timing=context.protocol.timing,
        settings_key=context.settings_key,
        row_key=key,
    )
    return row


def failed_rows(context: Context, unit: Unit, status: str, message: str) -> list[Row]:
    """Rows for work that could not be done."""
    return [
        identify(
            {**empty_row(), "status": status, "message": message},
            context,
            context.dataset.pairs[work.pair],
            combination,
            key,
        )
        for work in unit.work
        for combination, key in zip(work.combinations, work.row_keys, strict=True)
    ]


class Evaluator:
    """Evaluates units one after the other; methods are made once and kept."""

    def __init__(self, context: Context, announce: Announce) -> None:
        cv2.setNumThreads(1)
        self._context = context
        self._announce = announce
        self._clock = Clock(memory=context.protocol.timing == "exclusive")
        self._extractor = FeatureExtractor(self._clock, context.protocol.seed)
        self._detectors: dict[str, DetectorStage] = {}
        self._descriptors: dict[str, DescriptorStage] = {}
        self._matchers: dict[tuple[str, str], MatcherStage] = {}
        self._magsac = magsac_parameters(context.protocol.verification)

    def evaluate(self, unit: Unit) -> Iterable[Row]:
        """The rows of a unit, in the order of its work.

        An image's features are kept until the last pair of the unit that needs them.
        """
        pairs = [self._context.dataset.pairs[work.pair] for work in unit.work]
        last = {name: i for i, pair in enumerate(pairs) for name in (pair.image_1, pair.image_2)}
        cache: dict[str, ImageFeatures | StageError] = {}
        for position, (pair, work) in enumerate(zip(pairs, unit.work, strict=True)):
            yield from self._evaluate_pair(unit.detector, pair, work, cache)
            for name in (pair.image_1, pair.image_2):
                if last[name] == position:
                    cache.pop(name, None)

    def _evaluate_pair(
        self,
        detector: str,
        pair: Pair,
        work: PairWork,
        cache: dict[str, ImageFeatures | StageError],
    ) -> Iterable[Row]:
        repeatabilities: dict[tuple[bytes, bytes], float | None] = {}
        for combination, key in zip(work.combinations, work.row_keys, strict=True):
            row = identify(empty_row(), self._context, pair, combination, key)
            try:
                first = self._image(detector, pair.image_1, pair, cache)
                second = self._image(detector, pair.image_2, pair, cache)
                self._record_detection(row, first, second)
                described = (
                    self._described(first, detector, combination.descriptor, pair.image_1, pair),
                    self._described(second, detector, combination.descriptor, pair.image_2, pair),
                )
                features = PairFeatures(pair, (first, second), described)
                row["status"] = self._measure(row, features, combination, repeatabilities)
            except StageError as failure:
                row["status"], row["message"] = failure.status, failure.message
            yield add_metrics(row)

    def _image(
        self, detector: str, name: str, pair: Pair, cache: dict[str, ImageFeatures | StageError]
    ) -> ImageFeatures:
        if name not in cache:
            self._announce(StageCall("detect", pair.index, name, detector))
            try:
                if detector not in self._detectors:
                    self._detectors[detector] = run_stage(
                        detector, lambda: make_detector(self._context.methods, detector)
                    )
                image = self._context.dataset.image(name)
                cache[name] = self._extractor.detect(image, detector, self._detectors[detector])
            except StageError as failure:
                cache[name] = failure
        found = cache[name]
        if isinstance(found, StageError):
            raise found
        return found

    def _described(
        self, image: ImageFeatures, detector: str, descriptor: str, name: str, pair: Pair
    ) -> Described:
        if descriptor not in image.described:
            self._announce(StageCall("describe", pair.index, name, detector, descriptor))
            try:
                if descriptor not in self._descriptors:
                    self._descriptors[descriptor] = run_stage(
                        descriptor, lambda: make_descriptor(self._context.methods, descriptor)
                    )
                image.described[descriptor] = self._extractor.describe(
                    image,
                    descriptor,
                    f"{descriptor} describing {detector} keypoints of {name}",
                    self._descriptors[descriptor],
                )
            except StageError as failure:
                image.described[descriptor] = failure
        found = image.described[descriptor]
        if isinstance(found, StageError):
            raise found
        return found

    def _record_detection(self, row: Row, first: ImageFeatures, second: ImageFeatures) -> None:
        for side, image in ((1, first), (2, second)):
            _record_time(row, f"detect_seconds_{side}", image.detect_time)
        if not len(first.keypoints) or not len(second.keypoints):
            row["keypoints_1"], row["keypoints_2"] = len(first.keypoints), len(second.keypoints)
            raise StageError("no_keypoints", "")

    def _measure(
        self,
        row: Row,
        features: PairFeatures,
        combination: Combination,
        repeatabilities: dict[tuple[bytes, bytes], float | None],
    ) -> str:
        """Match, verify and measure; the status. The row keeps what was found until a failure."""
        first, second = (described.features for described in features.described)
        row["keypoints_1"], row["keypoints_2"] = len(first), len(second)
        for side, described in zip((1, 2), features.described, strict=True):
            _record_time(row, f"describe_seconds_{side}", described.time)
        row["descriptor_bytes"] = first.descriptors.shape[1] * first.descriptors.itemsize
        if not len(first) or not len(second):
            return "no_descriptors"
        matches = self._match(row, features, combination)
        row["matches"] = len(matches)
        points_1 = first.keypoints.xy[matches.indices[:, 0]]
        points_2 = second.keypoints.xy[matches.indices[:, 1]]
        status = self._verify(row, features.pair, combination, points_1, points_2)
        if features.pair.homography is not None:
            self._compare_with_truth(row, features, points_1, points_2, repeatabilities)
        return status

    def _match(self, row: Row, features: PairFeatures, combination: Combination) -> Matches:
        self._announce(self._call("match", features.pair, combination))
        what = f"{combination} matching {features.pair.image_1} and {features.pair.image_2}"
        kind = (combination.matcher, combination.norm)
        if kind not in self._matchers:
            self._matchers[kind] = run_stage(
                what, lambda: make_matcher(self._context.methods, *kind)
            )
        matcher = self._matchers[kind]
        first, second = (described.features for described in features.described)
        cv2.setRNGSeed(self._context.protocol.seed)
        raw, time = run_stage(what, lambda: self._clock.time(lambda: matcher.call(first, second)))
        _record_time(row, "match_seconds", time)
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
        self._announce(self._call("verify", pair, combination))
        what = f"verifying {combination} on {pair.image_1} and {pair.image_2}"
        cv2.setRNGSeed(protocol.seed)
        raw, time = run_stage(
            what,
            lambda: self._clock.time(lambda: find_fundamental(points_1, points_2, self._magsac)),
        )
        _record_time(row, "verify_seconds", time)
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
        features: PairFeatures,
        points_1: Float32Array,
        points_2: Float32Array,
        repeatabilities: dict[tuple[bytes, bytes], float | None],
    ) -> None:
        truth = features.pair.homography
        assert truth is not None
        errors = ground_truth.transfer_errors(points_1, points_2, truth)
        for threshold in PIXEL_THRESHOLDS:
            correct = int((errors <= threshold).sum())
            if len(errors):
                row[f"gt_precision@{threshold}"] = correct / len(errors)
            row[f"gt_matching_score@{threshold}"] = correct / row["keypoints_1"]
        pixels_1, pixels_2 = (image.pixels for image in features.images)
        xy_1, xy_2 = (described.features.keypoints.xy for described in features.described)
        same = (xy_1.tobytes(), xy_2.tobytes())
        if same not in repeatabilities:
            repeatabilities[same] = ground_truth.repeatability(
                xy_1, xy_2, truth, pixels_1, pixels_2
            )
        row["gt_repeatability"] = repeatabilities[same]
        model = run_stage(
            "estimating a homography",
            lambda: estimate_homography(points_1, points_2, self._context.protocol.verification),
        )
        row["homography_inliers"] = model.count
        error = ground_truth.corner_error(model.matrix, truth, pixels_1)
        row["homography_error"] = error
        for threshold in PIXEL_THRESHOLDS:
            row[f"homography_auc@{threshold}"] = ground_truth.area_under_curve(error, threshold)

    def _call(self, stage: str, pair: Pair, combination: Combination) -> StageCall:
        images = f"{pair.image_1} and {pair.image_2}"
        return StageCall(
            stage,
            pair.index,
            images,
            combination.detector,
            combination.descriptor,
            str(combination),
        )


def _record_time(row: Row, name: str, time: StageTime) -> None:
    row[name], row[f"{name}_cpu"] = time.wall, time.cpu
    if time.peak_memory is not None:
        row["peak_memory_mb"] = max(row["peak_memory_mb"] or 0.0, time.peak_memory)
