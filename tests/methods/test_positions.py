"""Whether keypoints lie where they should: in an image and in the same image turned or mirrored."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from aerocues.methods.arrays import Features, Keypoints
from aerocues.methods.combination import Combination
from aerocues.methods.detectors import DETECTORS
from aerocues.methods.making import make_descriptor, make_detector
from aerocues.methods.positions import PYRAMIDS
from aerocues.methods.presets import preset_named
from aerocues.methods.registry import Methods
from tests.methods.pictures import detect, textured

WIDTH, HEIGHT = 403, 299
OTHERWISE = {
    "BRISK": (803, 601),  # few keypoints on small levels
    "MSD": (203, 149),  # slow
    "TBMR": (280, 180),  # writes beyond its memory where extents are not multiples of four
}
# BRISK interpolates between levels whose places it does not know; HL finds whole pixels of levels.
LEFT = {"BRISK": 0.3, "HL": 0.3}
Image = NDArray[np.uint8]
Points = NDArray[Any]


@dataclass(frozen=True)
class Turn:
    """A change of an image, and the way back for positions in the changed one."""

    name: str
    change: Callable[[Image], Image]
    back: Callable[[Points, int, int], Points]


TURNS = (
    Turn(
        "half a turn",
        lambda image: image[::-1, ::-1],
        lambda xy, width, height: np.array([width - 1, height - 1]) - xy,
    ),
    Turn(
        "mirrored",
        lambda image: image[:, ::-1],
        lambda xy, width, _: np.column_stack([width - 1 - xy[:, 0], xy[:, 1]]),
    ),
    Turn(
        "a quarter",
        np.rot90,
        lambda xy, width, _: np.column_stack([width - 1 - xy[:, 1], xy[:, 0]]),
    ),
)


def under(preset: str, methods: Methods) -> Methods:
    return methods.with_preset(preset_named(preset))


def found(methods: Methods, name: str, image: Image, folder: Path) -> Keypoints:
    cv2.setNumThreads(1)
    cv2.setRNGSeed(0)
    return detect(methods, name, np.ascontiguousarray(image), folder)


def shifts(first: Keypoints, second: Points, octaves: Points) -> tuple[float, float]:
    """The largest mean difference on a level with twenty pairs or more, and the share of pairs."""
    largest, pairs = 0.0, 0
    for octave in np.unique(first.octave & 255):
        one, two = first.xy[first.octave & 255 == octave], second[octaves & 255 == octave]
        if not len(two):
            continue
        forth, there = cKDTree(two).query(one)
        back: Points = np.asarray(cKDTree(one).query(two)[1])
        paired = (back[there] == np.arange(len(one))) & (forth < 3)
        pairs += int(paired.sum())
        if paired.sum() >= 20:
            mean = (one - two[there])[paired].mean(axis=0)
            largest = max(largest, float(np.abs(mean).max()))
    return largest, pairs / len(first)


@pytest.mark.slow
@pytest.mark.opencv_versions
@pytest.mark.parametrize("name", [row.name for row in DETECTORS])
def test_keypoints_have_the_bias_that_the_table_tells_and_none_without_it(
    methods: Methods, name: str, tmp_path: Path
) -> None:
    size = OTHERWISE.get(name, (WIDTH, HEIGHT))
    image, row = textured(*size), methods.detectors[name]
    largest: dict[str, float] = {}
    for preset in ("thesis", "default"):
        known = under(preset, methods)
        here = found(known, name, image, tmp_path)
        assert len(here) > 30
        for turn in TURNS:
            there = found(known, name, turn.change(image), tmp_path)
            shift, share = shifts(here, turn.back(there.xy, *size), there.octave)
            largest[preset] = max(largest.get(preset, 0.0), shift, 1 - share)
            if preset == "default":
                assert shift < LEFT.get(name, 0.1), turn.name
                assert share > 0.7, turn.name
    assert bool(row.bias) == bool(row.unbiased)
    if row.bias:
        assert largest["thesis"] > 0.2
    else:
        assert under("thesis", methods).detectors[name] == under("default", methods).detectors[name]


def test_a_keypoint_of_orb_lies_where_its_pixel_of_the_level_does(methods: Methods) -> None:
    # 1,000 / 1.2 = 833.33: pixel 100 of the 833 covers 120.05 to 121.25, and 1.2 x 100 = 120.
    point = Keypoints.from_xy(np.array([[120.0, 120.0]], np.float32))
    point = Keypoints(**{**vars(point), "octave": np.array([1], np.int32)})
    parameters = methods.detectors["ORB"].parameters
    exact = PYRAMIDS["ORB"].exact(point, (1000, 600), parameters)
    assert exact.xy[0].tolist() == pytest.approx([100.5 * 1000 / 833 - 0.5, 100.5 * 1.2 - 0.5])
    again = PYRAMIDS["ORB"].as_found(exact, (1000, 600), parameters)
    np.testing.assert_allclose(again.xy, point.xy, rtol=1e-6)


@pytest.mark.opencv_versions
def test_orb_describes_the_places_where_it_found_keypoints(methods: Methods) -> None:
    image = textured(WIDTH, HEIGHT)
    described: dict[str, Features] = {}
    for preset in ("thesis", "default"):
        known = under(preset, methods)
        detector, descriptor = make_detector(known, "ORB"), make_descriptor(known, "ORB", "ORB")
        keypoints = detector.read(detector.call(image))
        described[preset] = descriptor.read(
            descriptor.call(image, descriptor.prepare(keypoints, image))
        )
    before, after = described["thesis"], described["default"]
    np.testing.assert_array_equal(before.descriptors, after.descriptors)
    moved = np.linalg.norm(before.keypoints.xy - after.keypoints.xy, axis=1)
    assert moved[before.keypoints.octave == 0].max() == 0
    assert moved[before.keypoints.octave == 5].min() > 0.2
    np.testing.assert_array_equal(before.keypoints.class_id, after.keypoints.class_id)


@pytest.mark.opencv_versions
def test_harris_laplace_sees_the_whole_of_a_colour_image(methods: Methods) -> None:
    image = textured(WIDTH, HEIGHT)
    image[:, WIDTH // 2 :] = 110
    detector = make_detector(under("default", methods), "HL")
    assert detector.read(detector.call(image)).xy[:, 0].max() < WIDTH / 2 + 5
    as_it_is = make_detector(under("thesis", methods), "HL")
    assert as_it_is.read(as_it_is.call(image)).xy[:, 0].max() > WIDTH - 30


def test_what_is_corrected_decides_row_keys_and_the_thesis_corrects_nothing(
    methods: Methods,
) -> None:
    for text in ("SIFT-SIFT-L2-BF", "ORB-ORB-HAM-BF", "TBMR-BRISK-HAM-BF"):
        combination = Combination.parse(text)
        as_in_the_table = methods.parameters(combination)
        assert under("thesis", methods).parameters(combination) == as_in_the_table
        for preset in ("default", "tuned"):
            assert under(preset, methods).parameters(combination) != as_in_the_table
