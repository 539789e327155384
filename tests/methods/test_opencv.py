"""Keypoints and descriptors on their way between arrays and OpenCV."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from numpy.typing import NDArray

from aerocues.methods.arrays import Features, Keypoints, Matches
from aerocues.methods.making import make_descriptor, make_detector
from aerocues.methods.opencv import Latch, OpenCVDescriptor
from aerocues.methods.parameters import create_opencv
from aerocues.methods.presets import as_preset
from aerocues.methods.registry import Methods
from tests.methods.pictures import strongest, textured

SINGLES = st.floats(-1e4, 1e4, width=32)
WORDS = st.integers(-(2**31), 2**31 - 1)


def found_in(image: NDArray[np.uint8], detector: str, methods: Methods) -> Keypoints:
    stage = make_detector(methods, detector)
    return stage.read(stage.call(image))


@st.composite
def keypoints(draw: st.DrawFn) -> Keypoints:
    count = draw(st.integers(0, 12))
    singles = draw(arrays.arrays(np.float32, (count, 5), elements=SINGLES))
    words = draw(arrays.arrays(np.int32, (count, 2), elements=WORDS))
    return Keypoints(
        singles[:, :2], singles[:, 2], singles[:, 3], singles[:, 4], words[:, 0], words[:, 1]
    )


def assert_same(first: Keypoints, second: Keypoints) -> None:
    for field in fields(Keypoints):
        left, right = getattr(first, field.name), getattr(second, field.name)
        assert left.dtype == right.dtype, field.name
        np.testing.assert_array_equal(left, right, err_msg=field.name)


@given(keypoints())
def test_keypoints_survive_the_way_through_opencv_exactly(points: Keypoints) -> None:
    assert_same(Keypoints.from_opencv(points.to_opencv()), points)


@pytest.mark.opencv_versions
def test_the_packed_octave_of_sift_survives(methods: Methods) -> None:
    row = methods.detectors["SIFT"]
    native = create_opencv(row.factory, row.parameters).detect(textured())
    found = Keypoints.from_opencv(native)
    assert found.octave.tolist() == [point.octave for point in native]
    # Octave in the lowest byte (255 is -1), layer in the next, sub-layer in the third.
    assert (found.octave & 255 == 255).any()
    assert found.octave.max() > 2**16
    returned = found.to_opencv()
    for before, after in zip(native, returned, strict=True):
        assert (before.pt, before.size, before.angle, before.response) == (
            after.pt,
            after.size,
            after.angle,
            after.response,
        )
        assert (before.octave, before.class_id) == (after.octave, after.class_id)


@pytest.mark.opencv_versions
def test_describing_arrays_equals_describing_the_keypoints_of_opencv(methods: Methods) -> None:
    image, row = textured(), methods.detectors["SIFT"]
    native = create_opencv(row.factory, row.parameters)
    _, direct = native.detectAndCompute(image, None)
    stage = make_descriptor(methods, "SIFT")
    found = Keypoints.from_opencv(native.detect(image))
    features = stage.read(stage.call(image, stage.prepare(found, image)))
    np.testing.assert_array_equal(features.descriptors, direct)


DROPPING = [("ORB", "FREAK"), ("MSD", "ORB"), ("GFTT", "BRIEF"), ("GFTT", "ORB"), ("FAST", "LATCH")]


@pytest.mark.opencv_versions
@pytest.mark.parametrize(("detector", "descriptor"), DROPPING)
def test_rows_belong_to_the_keypoints_that_compute_returned(
    methods: Methods, detector: str, descriptor: str
) -> None:
    """Each keypoint, described alone, gives the row that stands beside it."""
    image = textured(640, 400)
    found = strongest(found_in(image, detector, methods), 400)
    stage = make_descriptor(methods, descriptor)
    features = stage.read(stage.call(image, stage.prepare(found, image)))
    assert 0 < len(features) < len(found)
    again = stage.read(stage.call(image, stage.prepare(features.keypoints, image)))
    assert len(again) == len(features)
    np.testing.assert_array_equal(again.keypoints.xy, features.keypoints.xy)
    np.testing.assert_array_equal(again.descriptors, features.descriptors)
    for which in np.linspace(0, len(features) - 1, 12).astype(int):
        alone = stage.read(
            stage.call(image, stage.prepare(features.keypoints.take(which[None]), image))
        )
        np.testing.assert_array_equal(alone.descriptors[0], features.descriptors[which])
    # The list from before would have put other positions beside the same rows.
    assert not np.array_equal(found.xy[: len(features)], features.keypoints.xy)


@pytest.mark.opencv_versions
def test_rows_that_are_not_finite_are_dropped_with_their_keypoints(methods: Methods) -> None:
    image = textured(640, 400)
    stage = make_descriptor(methods, "KAZE")
    prepared = stage.prepare(strongest(found_in(image, "AKAZE", methods), 600), image)
    native, rows = raw = stage.call(image, prepared)
    finite = np.isfinite(rows).all(axis=1)
    assert 0 < finite.sum() < len(rows)
    features = stage.read(raw)
    np.testing.assert_array_equal(features.descriptors, rows[finite])
    assert_same(features.keypoints, Keypoints.from_opencv(native).take(finite))


@pytest.mark.opencv_versions
def test_latch_does_not_read_below_the_image(methods: Methods) -> None:
    """Without a blur OpenCV works on the rows themselves: what lies behind them is set here."""
    random = np.random.default_rng(0)
    height, width = 562, 1000
    memory = random.integers(0, 255, (height + 9, width), dtype=np.uint8)
    image = memory[:height]
    xy = [(x, height - below) for x in range(30, width - 27) for below in (40, 29, 28, 27.5, 27)]
    points = Keypoints.from_xy(np.array([*xy, (width - 27.5, height - 27.5)]))
    points = replace(points, angle=np.zeros(len(points), np.float32))
    row = methods.with_preset(as_preset("tuned")).descriptors["LATCH"]
    row = replace(row, parameters={**row.parameters, "sigma": 0.0})

    def described(latch: OpenCVDescriptor) -> list[Features]:
        found = []
        for behind in (0, 255):
            memory[height:] = behind
            found.append(latch.read(latch.call(image, latch.prepare(points, image))))
        return found

    first, second = described(Latch(row))
    np.testing.assert_array_equal(first.descriptors, second.descriptors)
    native, changed = described(OpenCVDescriptor(row))
    np.testing.assert_array_equal(first.keypoints.xy, native.keypoints.xy)
    kept = (native.descriptors == changed.descriptors).all(axis=1)
    assert set(first.keypoints.xy[~kept][:, 1]) <= {height - 27.5}
    np.testing.assert_array_equal(first.descriptors[kept], native.descriptors[kept])


@pytest.mark.opencv_versions
@pytest.mark.parametrize("descriptor", ["SIFT", "ORB", "FREAK", "DAISY", "BOOST"])
def test_no_keypoints_give_empty_features_of_the_right_form(
    methods: Methods, descriptor: str
) -> None:
    row = methods.descriptors[descriptor]
    stage = make_descriptor(methods, descriptor)
    features = stage.read(((), None))
    assert features.descriptors.shape == (0, row.columns)
    assert features.descriptors.dtype == row.dtype
    assert len(features.keypoints) == 0


def test_arrays_of_unequal_length_are_refused() -> None:
    three = Keypoints.from_xy(np.zeros((3, 2)))
    with pytest.raises(ValueError, match=r"\(3, D\)"):
        Features(three, np.zeros((2, 8), np.uint8))
    with pytest.raises(ValueError, match=r"size .*shape"):
        replace(three, size=three.size[:2])
    with pytest.raises(ValueError, match=r"xy .*\(N, 2\)"):
        replace(three, xy=np.zeros((3, 3), np.float32))
    with pytest.raises(ValueError, match=r"distance .*shape"):
        Matches(np.zeros((2, 2), np.int32), np.zeros(1, np.float32))
    with pytest.raises(ValueError, match=r"indices .*shape"):
        Matches(np.zeros((2, 3), np.int32), np.zeros(2, np.float32))


def test_keypoints_from_positions_alone_take_neutral_values() -> None:
    points = Keypoints.from_xy(np.array([[1.5, 2.5], [3, 4]]), size=12)
    assert points.xy.dtype == np.float32
    assert points.size.tolist() == [12, 12]
    assert points.angle.tolist() == [-1, -1]
    assert points.take(np.array([1])).xy.tolist() == [[3, 4]]
