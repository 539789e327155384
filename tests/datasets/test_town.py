from __future__ import annotations

from typing import Any

import cv2
import numpy as np
import pytest

from aerocues.datasets.town.scenery import town


def test_the_picture_is_the_same_at_every_drawing() -> None:
    first = town().copy()
    town.cache_clear()
    assert np.array_equal(first, town())
    assert first.shape == (665, 1000, 3)
    assert first.dtype == np.uint8
    assert not town().flags.writeable


def test_it_is_exposed_like_a_photograph() -> None:
    gray = cv2.cvtColor(town().copy(), cv2.COLOR_BGR2GRAY)
    assert 80 < float(gray.mean()) < 140
    assert 30 < float(gray.std()) < 60
    assert float(((gray == 0) | (gray == 255)).mean()) < 0.01


def test_every_part_of_it_has_texture() -> None:
    gray = cv2.cvtColor(town().copy(), cv2.COLOR_BGR2GRAY)
    tiles = [
        gray[row : row + 95, column : column + 100]
        for row in range(0, 665, 95)
        for column in range(0, 1000, 100)
    ]
    assert min(float(tile.std()) for tile in tiles) > 5


@pytest.mark.parametrize(
    "create",
    ["ORB_create", "SIFT_create", "FastFeatureDetector_create", "MSER_create"],
)
def test_detectors_find_enough_of_it(create: str) -> None:
    detector: Any = getattr(cv2, create)()
    assert len(detector.detect(town().copy(), None)) > 300
