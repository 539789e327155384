"""Evaluates a unit: detects and describes each image once, then measures pair after pair."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TypeVar

import cv2

from aerocues.datasets.dataset import Image, Pair
from aerocues.evaluation.rows import begin_row
from aerocues.evaluation.truth_comparison import TwoViews
from aerocues.evaluation.two_views import Announce, TwoViewMeasurement, record_time
from aerocues.evaluation.unit import Context, PairWork, Unit
from aerocues.methods.combination import Combination
from aerocues.methods.making import DescriptorStage, DetectorStage, make_descriptor, make_detector
from aerocues.pipeline.clock import Clock
from aerocues.pipeline.feature_cache import FeatureCache
from aerocues.pipeline.feature_folder import FeatureFolder
from aerocues.pipeline.features import (
    Described,
    FeatureExtractor,
    ImageFeatures,
    StageError,
    run_stage,
)
from aerocues.processes.call import StageCall
from aerocues.results.metrics import Row, add_metrics

Found = TypeVar("Found")


class Evaluator:
    """Evaluates units one after the other; methods are made once and kept.

    Parameters
    ----------
    context : Context
    announce : callable
        Told of each stage call before it begins.
    """

    def __init__(self, context: Context, announce: Announce) -> None:
        cv2.setNumThreads(1)
        protocol = context.protocol
        clock = Clock(protocol.seed, exclusive=protocol.timing == "exclusive")
        self._context = context
        self._announce = announce
        self._extractor = FeatureExtractor(clock, protocol.seed, protocol.limit)
        self._two_views = TwoViewMeasurement(context, clock, announce)
        self._cache = FeatureCache()
        self._folder = (
            FeatureFolder(context.features, context.methods, protocol, context.machine)
            if context.features
            else None
        )
        self._detectors: dict[str, DetectorStage] = {}
        self._descriptors: dict[str, DescriptorStage] = {}

    def evaluate(self, unit: Unit) -> Iterator[list[Row]]:
        """The rows of each pair of a unit, in the order of its work.

        An image's features are kept until the last pair of the unit that needs them, and beyond,
        for other units, as long as there is room.
        """
        pairs = [self._context.dataset.pair(work.pair) for work in unit.work]
        for position, (pair, work) in enumerate(zip(pairs, unit.work, strict=True)):
            yield list(self._evaluate_pair(unit.detector, pair, work))
            left = pairs[position + 1 :]
            names = {name for later in left for name in (later.image_1, later.image_2)}
            self._cache.trim(frozenset((unit.detector, name) for name in names))

    def _image(self, detector: str, name: str, pair: Pair) -> ImageFeatures | StageError:
        found = self._cache.get((detector, name))
        if found is None:
            found = self._detect(detector, name, pair)
            self._cache.put((detector, name), found)
        return found

    def _evaluate_pair(self, detector: str, pair: Pair, work: PairWork) -> Iterator[Row]:
        self._two_views.begin_pair()
        images = [self._image(detector, name, pair) for name in (pair.image_1, pair.image_2)]
        for combination, key in zip(work.combinations, work.row_keys, strict=True):
            row = begin_row(self._context, pair, combination, key)
            try:
                first, second = map(_unless_failed, images)
                _record_detection(row, first, second)
                described = (
                    self._describe(first, combination, pair.image_1, pair),
                    self._describe(second, combination, pair.image_2, pair),
                )
                views = TwoViews(pair, (first, second), described)
                row["status"] = self._two_views.measure(row, views, combination)
            except StageError as failure:
                row["status"], row["message"] = failure.status, failure.message
            if self._folder is not None and row["message"] is None:
                row["message"] = self._folder.problem
            yield add_metrics(row)

    def _detect(self, name: str, image_name: str, pair: Pair) -> ImageFeatures | StageError:
        self._announce(StageCall("detect", pair.index, image_name, name))
        image = self._context.dataset.image(image_name)
        kept = self._folder.keypoints(image, name) if self._folder else None
        try:
            if kept is not None:
                return self._extractor.read(image, *kept)
            if name not in self._detectors:
                self._detectors[name] = run_stage(
                    name, lambda: make_detector(self._context.methods, name)
                )
            found = self._extractor.detect(image, name, self._detectors[name])
        except StageError as failure:
            return failure
        if self._folder:
            self._folder.keep_keypoints(image, name, found.keypoints, found.detect_time)
        return found

    def _describe(
        self, image: ImageFeatures, combination: Combination, image_name: str, pair: Pair
    ) -> Described:
        name = combination.descriptor
        if name not in image.described:
            detector = combination.detector
            self._announce(StageCall("describe", pair.index, image_name, detector, name))
            source = self._context.dataset.image(image_name)
            kept = self._folder.described(source, detector, name) if self._folder else None
            image.described[name] = kept or self._describe_anew(image, name, detector, source)
        return _unless_failed(image.described[name])

    def _describe_anew(
        self, image: ImageFeatures, name: str, detector: str, source: Image
    ) -> Described | StageError:
        what = f"{name} describing {detector} keypoints of {source.name}"
        try:
            descriptor = self._descriptor(name, detector)
            described = self._extractor.describe(image, name, what, descriptor)
        except StageError as failure:
            return failure
        if self._folder:
            self._folder.keep_described(source, detector, name, described)
        return described

    def _descriptor(self, name: str, detector: str) -> DescriptorStage:
        methods = self._context.methods
        both = f"{detector}-{name}"
        own = both if both in methods.on_detectors else name
        if own not in self._descriptors:
            self._descriptors[own] = run_stage(
                name, lambda: make_descriptor(methods, name, detector)
            )
        return self._descriptors[own]


def _unless_failed(found: Found | StageError) -> Found:
    if isinstance(found, StageError):
        raise found
    return found


def _record_detection(row: Row, first: ImageFeatures, second: ImageFeatures) -> None:
    record_time(row, "detect_seconds_1", first.detect_time)
    record_time(row, "detect_seconds_2", second.detect_time)
    if not len(first.keypoints) or not len(second.keypoints):
        row["keypoints_1"], row["keypoints_2"] = len(first.keypoints), len(second.keypoints)
        raise StageError("no_keypoints", None)
