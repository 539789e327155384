from __future__ import annotations

import gc
import tracemalloc
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from aerocues.datasets.dataset import Dataset
from aerocues.errors import ArgumentError, ImageError, MethodFailedError, SelectionError
from aerocues.methods.presets import Preset
from aerocues.pipeline.clock import Clock
from aerocues.pipeline.feature_source import FeatureSource
from aerocues.pipeline.features import Failure
from aerocues.pipeline.pipeline import Pipeline
from tests.evaluation.inline import InlineEngine
from tests.evaluation.scenes import rows_of
from tests.evaluation.test_plan import context_of


@pytest.mark.parametrize(
    "combination", ["ORB-ORB-HAM-BF", "SIFT-SIFT-L2-FLANN", "ORB-BRISK-HAM-EXACT"]
)
def test_a_pipeline_gives_what_a_run_measures(
    combination: str, views: Dataset, tmp_path: Path
) -> None:
    from aerocues.evaluation.run import run

    results = run(views, combination, tmp_path / "r", timing="shared", engine=InlineEngine())
    (row,) = (row for row in rows_of(results.table()).values() if row["pair"] == 0)
    pipeline = Pipeline(combination.lower())
    images = [views.image(str(row[name])) for name in ("image_1", "image_2")]
    first, second = (pipeline.features(image) for image in images)
    matches = pipeline.match(first, second)
    verdict = pipeline.verify(first, second, matches)
    assert (len(first), len(second)) == (row["keypoints_1"], row["keypoints_2"])
    assert len(matches) == row["matches"]
    assert verdict.model.count == row["inliers"]
    assert verdict.status == row["status"] == "ok"
    assert verdict.model.matrix is not None


def test_a_path_an_array_and_an_image_give_the_same(views: Dataset, tmp_path: Path) -> None:
    pipeline = Pipeline("ORB-ORB-HAM-BF", max_keypoints=100)
    bgr = views.images[0].read().bgr
    assert cv2.imwrite(str(tmp_path / "view.png"), bgr)
    found = [pipeline.features(image) for image in (views.images[0], bgr, tmp_path / "view.png")]
    assert 0 < len(found[0]) <= 100
    for other in found[1:]:
        assert np.array_equal(found[0].keypoints.xy, other.keypoints.xy)
        assert np.array_equal(found[0].descriptors, other.descriptors)


def test_another_image_of_the_same_name_is_another_image(views: Dataset) -> None:
    pipeline = Pipeline("ORB-ORB-HAM-BF")
    first, second = (pipeline.features(image.read().bgr) for image in views.images[:2])
    assert not np.array_equal(first.keypoints.xy, second.keypoints.xy)


def test_nothing_to_match_is_no_error() -> None:
    pipeline = Pipeline("SIFT-SIFT-L2-FLANN")
    nothing = pipeline.features(np.full((80, 90), 7, np.uint8))
    assert len(nothing) == 0
    assert nothing.descriptors.shape == (0, 128)
    assert nothing.descriptors.dtype == np.float32
    matches = pipeline.match(nothing, nothing)
    assert len(matches) == 0
    verdict = pipeline.verify(nothing, nothing, matches)
    assert (verdict.passed, verdict.model.matrix, len(verdict.model.inliers)) == (False, None, 0)


def test_a_threshold_of_a_preset_decides_the_inliers(views: Dataset) -> None:
    strict = Preset("strict", "half a pixel", chance_test=True, thresholds={"ORB-ORB": 0.5})
    counts = []
    for preset in ("default", strict):
        pipeline = Pipeline("ORB-ORB-HAM-BF", preset)
        first, second = (pipeline.features(image) for image in views.images[:2])
        matches = pipeline.match(first, second)
        counts.append(pipeline.verify(first, second, matches).model.count)
    assert 0 < counts[1] < counts[0]


def test_wrong_arguments_are_errors(tmp_path: Path) -> None:
    with pytest.raises(SelectionError):
        Pipeline("ORB-ORB-HAM")
    with pytest.raises(SelectionError):
        Pipeline("ORB-ORB-HAM-*")
    with pytest.raises(SelectionError):
        Pipeline("ORB-SIFT-HAM-BF")
    with pytest.raises(ArgumentError):
        Pipeline("ORB-ORB-HAM-BF", max_keypoints=-1)
    pipeline = Pipeline("ORB-ORB-HAM-BF")
    with pytest.raises(ImageError):
        pipeline.features(tmp_path / "missing.png")
    with pytest.raises(ImageError):
        pipeline.features(np.zeros((4, 4), np.float32))


def test_what_a_method_raises_is_one_error_that_names_it(
    views: Dataset, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise cv2.error("it does not work")

    monkeypatch.setattr("aerocues.methods.opencv.OpenCVDescriptor.call", fail)
    with pytest.raises(MethodFailedError, match=r"ORB describing ORB keypoints .* does not work"):
        Pipeline("ORB-ORB-HAM-BF").features(views.images[0])


def test_a_failure_keeps_no_memory(views: Dataset, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> None:
        taken = np.ones(40_000_000, np.uint8)
        raise ValueError(f"failed with {len(taken)} bytes in hand")

    monkeypatch.setattr("aerocues.methods.opencv.OpenCVDetector.call", fail)
    context = context_of(views)
    protocol = replace(context.protocol, timing="shared")
    source = FeatureSource(context.methods, protocol, Clock())
    tracemalloc.start()
    try:
        found = [source.detected(image, "ORB") for image in views.images]
        gc.disable()
        held, _ = tracemalloc.get_traced_memory()
    finally:
        gc.enable()
        tracemalloc.stop()
    assert all(isinstance(each, Failure) and each.status == "error" for each in found)
    assert held < 20_000_000
