from __future__ import annotations

import numpy as np

from aerocues.datasets.dataset import Image, Pixels
from aerocues.datasets.decoded import DecodedSource
from aerocues.methods.arrays import Features, Keypoints
from aerocues.pipeline.clock import StageTime
from aerocues.pipeline.feature_cache import FeatureCache
from aerocues.pipeline.features import Described, Failure, ImageFeatures

TIME = StageTime(0.0, 0.0)


def image(described: int = 0) -> ImageFeatures:
    keypoints = Keypoints.from_xy(np.zeros((10, 2)))
    pixels = Pixels(np.zeros((100, 100, 3), np.uint8))
    found = ImageFeatures(Image("1", DecodedSource(pixels)), pixels, keypoints, TIME)
    if described:
        features = Features(keypoints, np.zeros((10, described), np.uint8))
        found.described["ORB"] = Described(features, TIME)
    return found


def test_what_was_used_longest_ago_goes_first() -> None:
    cache = FeatureCache(most=80_000)
    first, second, third = image(), image(), image()
    for name, features in (("1", first), ("2", second), ("3", third)):
        cache.put(("ORB", name), features)
    assert cache.get(("ORB", "1")) is first
    cache.trim(frozenset())
    assert cache.get(("ORB", "2")) is None
    assert (cache.get(("ORB", "1")), cache.get(("ORB", "3"))) == (first, third)


def test_what_is_needed_stays_however_large() -> None:
    cache = FeatureCache(most=10)
    kept = image()
    cache.put(("ORB", "1"), kept)
    cache.trim(frozenset({("ORB", "1")}))
    assert cache.get(("ORB", "1")) is kept
    cache.trim(frozenset())
    assert cache.get(("ORB", "1")) is None


def test_descriptors_count_and_failures_are_forgotten() -> None:
    cache = FeatureCache(most=100_000)
    cache.put(("ORB", "1"), image(described=10_000))
    cache.put(("ORB", "2"), Failure("out_of_memory", "not enough"))
    cache.trim(frozenset())
    assert cache.get(("ORB", "1")) is None
    assert cache.get(("ORB", "2")) is None
