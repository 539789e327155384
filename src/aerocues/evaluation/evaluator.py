"""Evaluates a unit: detects and describes each image once, then measures pair after pair."""

from __future__ import annotations

from collections.abc import Iterator

from aerocues.datasets.dataset import Pair
from aerocues.evaluation.rows import begin_row
from aerocues.evaluation.truth_comparison import TwoViews
from aerocues.evaluation.two_views import TwoViewMeasurement, record_time
from aerocues.evaluation.unit import Context, PairWork, Unit
from aerocues.methods.combination import Combination
from aerocues.phrases import printable
from aerocues.pipeline.clock import Clock
from aerocues.pipeline.feature_folder import FeatureFolder
from aerocues.pipeline.feature_source import Announce, FeatureSource
from aerocues.pipeline.features import ImageFeatures, StageError, unless_failed
from aerocues.results.metrics import Row, add_metrics


class Evaluator:
    """Evaluates units one after the other; methods are made once and kept.

    Parameters
    ----------
    context : Context
    announce : callable
        Called with each stage call before it begins.
    """

    def __init__(self, context: Context, announce: Announce) -> None:
        protocol, methods = context.protocol, context.methods
        clock = Clock(protocol.seed, exclusive=protocol.timing == "exclusive")
        folder = None
        if context.features:
            folder = FeatureFolder(context.features, methods, protocol, context.machine)
        self._context = context
        self._features = FeatureSource(methods, protocol, clock, folder=folder, announce=announce)
        self._two_views = TwoViewMeasurement(context, clock, announce)

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
            self._features.trim(frozenset((unit.detector, name) for name in names))

    def _evaluate_pair(self, detector: str, pair: Pair, work: PairWork) -> Iterator[Row]:
        self._two_views.begin_pair(pair)
        images = [self._context.dataset.image(name) for name in (pair.image_1, pair.image_2)]
        detected = [self._features.detected(image, detector, pair.index) for image in images]
        for combination, key in zip(work.combinations, work.row_keys, strict=True):
            row = begin_row(self._context, pair, combination, key)
            self._two_views.begin_row(row)
            try:
                first, second = map(unless_failed, detected)
                row["status"] = self._measure(row, pair, (first, second), combination)
            except StageError as failure:
                row["status"], row["message"] = failure.status, failure.message
            message = self._features.problem if row["message"] is None else row["message"]
            row["message"] = None if message is None else printable(message)
            yield add_metrics(row)

    def _measure(
        self,
        row: Row,
        pair: Pair,
        images: tuple[ImageFeatures, ImageFeatures],
        combination: Combination,
    ) -> str:
        """Fill the row of a combination; the status."""
        first, second = images
        if combination.guided or not combination.of_pairs:
            _record_detection(row, first, second)
        if combination.of_pairs:
            return self._two_views.measure_images(row, pair, images, combination)
        described = (
            self._features.described(first, combination, pair.index),
            self._features.described(second, combination, pair.index),
        )
        return self._two_views.measure(row, TwoViews(pair, images, described), combination)


def _record_detection(row: Row, first: ImageFeatures, second: ImageFeatures) -> None:
    record_time(row, "detect_seconds_1", first.detect_time)
    record_time(row, "detect_seconds_2", second.detect_time)
    if not len(first.keypoints) or not len(second.keypoints):
        row["keypoints_1"], row["keypoints_2"] = len(first.keypoints), len(second.keypoints)
        raise StageError("no_keypoints", None)
