"""Every combination that is said to run does run, and the others are really refused."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from aerocues.methods.arrays import Features, Keypoints
from aerocues.methods.combination import Combination
from aerocues.methods.making import make_descriptor, make_matcher
from aerocues.methods.registry import Methods, opencv_methods
from aerocues.methods.selection import runnable
from tests.methods.pictures import detect, shifted_pair, strongest

ENOUGH = 80
SMALL = (200, 150)
# AKAZE's pyramid has as many levels as KAZE's from this size on, and FREAK's pattern on keypoints
# of ORB's upper levels fits in.
LARGE = (640, 330)
DETECTORS = [name for name, row in opencv_methods().detectors.items() if not row.of_pairs]


@dataclass(frozen=True)
class Scene:
    """Two pictures that overlap, and a detector's keypoints in them."""

    images: tuple[NDArray[np.uint8], NDArray[np.uint8]]
    keypoints: tuple[Keypoints, Keypoints]

    def describe(self, methods: Methods, descriptor: str) -> list[Features]:
        stage = make_descriptor(methods, descriptor)
        return [
            stage.read(stage.call(image, stage.prepare(keypoints, image)))
            for image, keypoints in zip(self.images, self.keypoints, strict=True)
        ]


MakeScene = Callable[[str], Scene]


@pytest.fixture(scope="module")
def scene_of(methods: Methods, tmp_path_factory: pytest.TempPathFactory) -> MakeScene:
    folder = tmp_path_factory.mktemp("scene")

    @cache
    def make(detector: str) -> Scene:
        images = shifted_pair(*(LARGE if detector in ("ORB", "KAZE") else SMALL))
        first, second = (detect(methods, detector, image, folder) for image in images)
        return Scene(images, (strongest(first, ENOUGH), strongest(second, ENOUGH)))

    return make


def of(detector: str) -> list[Combination]:
    return [c for c in runnable(opencv_methods()) if c.detector == detector]


@pytest.mark.opencv_versions
@pytest.mark.parametrize("detector", DETECTORS)
def test_every_runnable_combination_of_a_detector_runs(
    methods: Methods, scene_of: MakeScene, detector: str
) -> None:
    scene = scene_of(detector)
    assert all(len(keypoints) >= 8 for keypoints in scene.keypoints)
    described: dict[str, list[Features]] = {}
    for combination in of(detector):
        name = combination.descriptor
        if name not in described:
            described[name] = scene.describe(methods, name)
        first, second = described[name]
        row = methods.descriptors[name]
        for features in (first, second):
            assert features.descriptors.dtype == row.dtype, combination
            assert features.descriptors.shape == (len(features.keypoints), row.columns)
            assert np.isfinite(features.descriptors).all()
        assert len(first), combination
        assert len(second), combination
        cv2.setRNGSeed(0)
        matcher = make_matcher(methods, combination.matcher, combination.norm)
        matches = matcher.read(matcher.call(first, second))
        assert matches.indices.dtype == np.int32
        assert matches.distance.dtype == np.float32
        if len(matches):
            assert matches.indices.min() >= 0
            assert (matches.indices.max(axis=0) < (len(first), len(second))).all()
        for column in (0, 1):
            assert len(np.unique(matches.indices[:, column])) == len(matches), combination


def test_the_runs_above_are_all_467() -> None:
    assert sum(len(of(detector)) for detector in DETECTORS) == 467


@pytest.mark.opencv_versions
@pytest.mark.parametrize("descriptor", ["SIFT", "KAZE", "VGG", "DAISY"])
@pytest.mark.parametrize("matcher", ["BF", "FLANN"])
def test_opencv_refuses_the_hamming_norm_on_numbers(
    methods: Methods, scene_of: MakeScene, descriptor: str, matcher: str
) -> None:
    first, second = scene_of("KAZE").describe(methods, descriptor)
    with pytest.raises(cv2.error):
        make_matcher(methods, matcher, "HAM").call(first, second)


@pytest.mark.opencv_versions
@pytest.mark.parametrize("descriptor", ["ORB", "BRIEF", "LATCH", "LUCID"])
def test_opencv_refuses_a_tree_over_bytes(
    methods: Methods, scene_of: MakeScene, descriptor: str
) -> None:
    first, second = scene_of("ORB").describe(methods, descriptor)
    with pytest.raises(cv2.error):
        make_matcher(methods, "FLANN", "L2").call(first, second)


@pytest.mark.opencv_versions
@pytest.mark.parametrize("detector", ["BRISK", "FAST", "GFTT"])
@pytest.mark.parametrize("descriptor", ["AKAZE", "KAZE"])
def test_opencv_refuses_foreign_keypoints(
    methods: Methods, scene_of: MakeScene, detector: str, descriptor: str
) -> None:
    with pytest.raises(cv2.error):
        scene_of(detector).describe(methods, descriptor)


@pytest.mark.opencv_versions
def test_lucid_cannot_describe_a_gray_image(methods: Methods, scene_of: MakeScene) -> None:
    stage, scene = make_descriptor(methods, "LUCID"), scene_of("FAST")
    gray = cv2.cvtColor(scene.images[0], cv2.COLOR_BGR2GRAY)
    with pytest.raises(cv2.error):
        stage.call(gray, stage.prepare(scene.keypoints[0], gray))


@pytest.mark.opencv_versions
def test_akaze_refuses_deep_kaze_keypoints_of_small_images(methods: Methods) -> None:
    image, _ = shifted_pair(*SMALL)
    found = detect(methods, "KAZE", image, Path())
    # KAZE numbers the levels of its pyramid 0 to 14, whatever the size of the image.
    deepest = replace(found, class_id=np.full(len(found), 14, np.int32))
    stage = make_descriptor(methods, "AKAZE")
    with pytest.raises(cv2.error):
        stage.call(image, stage.prepare(deepest, image))
