from __future__ import annotations

import numpy as np
import pytest

from aerocues.datasets.dataset import Image
from aerocues.datasets.decoded import DecodedSource, pixels_of
from aerocues.errors import SelectionError
from aerocues.methods.presets import METHOD_PRESETS
from aerocues.methods.registry import opencv_methods
from aerocues.pipeline.equal_footing import reach_keypoints, survey_image
from tests.methods.pictures import textured

DEFAULT = METHOD_PRESETS[0]
METHODS = opencv_methods()


def image(contrast: float = 0.25) -> Image:
    """A picture of low contrast, in which thresholds matter."""
    whole = textured(320, 240, seed=4).astype(np.float64)
    return Image("a", DecodedSource(pixels_of((110 + contrast * (whole - 110)).astype(np.uint8))))


def test_thresholds_are_lowered_until_the_number_is_reached() -> None:
    before, few = reach_keypoints(METHODS, DEFAULT, image(), ["SIFT", "MSER"], 1)
    assert [footing.steps for footing in few] == [0, 0]
    assert before.detectors == {}
    wanted = 2 * few[0].keypoints
    preset, footings = reach_keypoints(METHODS, DEFAULT, image(), ["SIFT", "TBMR"], wanted)
    sift, tbmr = footings
    assert sift.steps > 0
    assert sift.keypoints > few[0].keypoints
    assert sift.value == pytest.approx(0.04 * 0.5**sift.steps)
    assert preset.detectors == {"SIFT": {"contrastThreshold": sift.value}}
    assert preset.name == f"default-{wanted}"
    assert (tbmr.parameter, tbmr.reached) == (None, False)
    assert reach_keypoints(METHODS, DEFAULT, image(), ["SIFT", "TBMR"], wanted)[0] == preset


def test_a_threshold_ends_where_it_makes_no_sense_any_more() -> None:
    blank = Image("a", DecodedSource(pixels_of(np.full((90, 90), 7, np.uint8))))
    names = [name for name, row in METHODS.detectors.items() if row.threshold and name != "HL"]
    preset, footings = reach_keypoints(METHODS, DEFAULT, blank, names, 100)
    for footing in footings:
        row = METHODS.detectors[footing.detector]
        assert row.threshold is not None
        assert not footing.reached
        assert footing.value is not None
        assert float(footing.value) >= row.threshold[1]
        assert footing.steps > 0
    preset.check(METHODS.detectors, METHODS.descriptors)


def test_the_middle_image_is_looked_at() -> None:
    images = [image(), image(), image()]
    assert survey_image(images) is images[1]
    with pytest.raises(SelectionError):
        reach_keypoints(METHODS, DEFAULT, images[0], ["SIFT"], 0)
