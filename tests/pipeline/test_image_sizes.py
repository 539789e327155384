"""Features tell matchers how large their image is, wherever they come from."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from aerocues.datasets.dataset import Image, Pixels
from aerocues.datasets.decoded import DecodedSource
from aerocues.methods.combination import Combination
from aerocues.methods.registry import opencv_methods
from aerocues.pipeline.clock import Clock
from aerocues.pipeline.feature_folder import FeatureFolder
from aerocues.pipeline.feature_source import FeatureSource
from aerocues.pipeline.protocol import MeasurementProtocol
from aerocues.reconstruction.feature_size import smaller

ORB = Combination.parse("ORB-ORB-HAM-BF")
NOISE = np.random.default_rng(0).integers(0, 255, (120, 200, 3), dtype=np.uint8)


def image(pixels: np.ndarray) -> Image:
    return Image("1", DecodedSource(Pixels(pixels)))


def source(folder: FeatureFolder | None = None) -> FeatureSource:
    return FeatureSource(opencv_methods(), MeasurementProtocol(), Clock(0), folder=folder)


def test_of_an_image_with_keypoints_and_of_one_without() -> None:
    for pixels in (NOISE, np.zeros_like(NOISE)):
        assert source().features(image(pixels), ORB).features.image_size == (200, 120)
    small = smaller(image(NOISE), 100)
    assert source().features(small, ORB).features.image_size == (100, 60)


def test_of_features_that_were_kept(tmp_path: Path) -> None:
    folder = FeatureFolder(tmp_path, opencv_methods(), MeasurementProtocol(), "here")
    first = source(folder).features(image(NOISE), ORB).features
    again = source(folder).features(image(NOISE), ORB).features
    assert first.image_size == again.image_size == (200, 120)
    assert np.array_equal(first.descriptors, again.descriptors)
    assert again.take(np.array([1, 0])).image_size == (200, 120)
