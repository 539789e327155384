from __future__ import annotations

from dataclasses import replace
from typing import Any

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from numpy.typing import NDArray

from aerocues.errors import MethodUnavailableError
from aerocues.methods.arrays import Features, Keypoints, Matches
from aerocues.methods.combination import Combination
from aerocues.methods.making import make_descriptor, make_detector, make_matcher
from aerocues.methods.matchers import NormRow
from aerocues.methods.registry import Methods, opencv_methods
from aerocues.methods.selection import select
from tests.methods.pictures import shifted_pair, strongest


def features(descriptors: NDArray[Any]) -> Features:
    return Features(Keypoints.from_xy(np.zeros((len(descriptors), 2))), descriptors)


def match(
    name: str,
    norm: str,
    first: NDArray[Any],
    second: NDArray[Any],
    methods: Methods | None = None,
) -> Matches:
    matcher = make_matcher(methods or opencv_methods(), name, norm)
    return matcher.read(matcher.call(features(first), features(second)))


def distances(first: NDArray[Any], second: NDArray[Any], norm: str) -> NDArray[np.float64]:
    if norm == "HAM":
        differing = first[:, None, :] ^ second[None, :, :]
        counts: NDArray[np.float64] = np.unpackbits(differing, axis=2).sum(axis=2).astype(float)
        return counts
    difference = first[:, None, :].astype(np.float64) - second[None, :, :].astype(np.float64)
    lengths: NDArray[np.float64] = np.sqrt((difference**2).sum(axis=2))
    return lengths


def mutual_neighbours(table: NDArray[np.float64]) -> list[tuple[int, int]]:
    """Each the other's nearest; where several are equally near, the first counts."""
    forth, back = table.argmin(axis=1), table.argmin(axis=0)
    return [(i, int(j)) for i, j in enumerate(forth) if back[j] == i]


def assert_mutual_neighbours(norm: str, first: NDArray[Any], second: NDArray[Any]) -> None:
    matches = match("BF", norm, first, second)
    table = distances(first, second, norm)
    assert [tuple(pair) for pair in matches.indices.tolist()] == mutual_neighbours(table)
    expected = table[matches.indices[:, 0], matches.indices[:, 1]]
    np.testing.assert_allclose(matches.distance, expected, rtol=1e-6)


# Few values, so that many distances are equal.
def few_values(dtype: type, columns: int) -> st.SearchStrategy[NDArray[Any]]:
    shapes = st.tuples(st.integers(1, 9), st.just(columns))
    return arrays.arrays(dtype, shapes, elements=st.integers(0, 3).map(float))


@pytest.mark.opencv_versions
@given(few_values(np.uint8, 4), few_values(np.uint8, 4))
def test_brute_force_equals_mutual_neighbours_by_bits(
    first: NDArray[np.uint8], second: NDArray[np.uint8]
) -> None:
    assert_mutual_neighbours("HAM", first, second)


@pytest.mark.opencv_versions
@given(few_values(np.float32, 3), few_values(np.float32, 3))
def test_brute_force_equals_mutual_neighbours_by_distance(
    first: NDArray[np.float32], second: NDArray[np.float32]
) -> None:
    assert_mutual_neighbours("L2", first, second)


@pytest.mark.opencv_versions
@pytest.mark.parametrize(("norm", "columns"), [("HAM", 32), ("HAM", 61), ("HAM", 2), ("L2", 128)])
def test_brute_force_equals_mutual_neighbours_on_many(norm: str, columns: int) -> None:
    random = np.random.default_rng(columns)
    dtype = np.uint8 if norm == "HAM" else np.float32
    first = random.integers(0, 256, (250, columns)).astype(dtype)
    second = np.concatenate([first[::3], random.integers(0, 256, (150, columns)).astype(dtype)])
    assert_mutual_neighbours(norm, first, second)


@pytest.mark.opencv_versions
def test_brute_force_takes_bytes_as_numbers_under_l2() -> None:
    random = np.random.default_rng(4)
    first, second = random.integers(0, 256, (2, 80, 16)).astype(np.uint8)
    assert_mutual_neighbours("L2", first, second)


@pytest.fixture(scope="module")
def described(methods: Methods) -> dict[str, tuple[Features, Features]]:
    found: dict[str, tuple[Features, Features]] = {}
    for name in ("ORB", "SIFT"):
        detector, descriptor = make_detector(methods, name), make_descriptor(methods, name)
        both = []
        for image in shifted_pair(480, 360):
            points = strongest(detector.read(detector.call(image)), 500)
            both.append(descriptor.read(descriptor.call(image, descriptor.prepare(points, image))))
        found[name] = (both[0], both[1])
    return found


@pytest.mark.opencv_versions
@pytest.mark.parametrize(("name", "norm"), [("ORB", "HAM"), ("SIFT", "L2")])
def test_flann_is_mutual_and_repeats_under_a_seed(
    described: dict[str, tuple[Features, Features]], name: str, norm: str
) -> None:
    first, second = described[name]
    matcher = make_matcher(opencv_methods(), "FLANN", norm)

    def seeded(seed: int) -> Matches:
        cv2.setRNGSeed(seed)
        return matcher.read(matcher.call(first, second))

    once, again = seeded(3), seeded(3)
    np.testing.assert_array_equal(once.indices, again.indices)
    np.testing.assert_array_equal(once.distance, again.distance)
    assert len(once) > 50
    for column in (0, 1):
        assert len(np.unique(once.indices[:, column])) == len(once)
    pairs = once.indices
    table = distances(first.descriptors, second.descriptors, norm)
    np.testing.assert_allclose(once.distance, table[pairs[:, 0], pairs[:, 1]], rtol=1e-5)
    exact = set(mutual_neighbours(table))
    assert len(exact & {(int(i), int(j)) for i, j in pairs}) > 0.5 * len(exact)


@pytest.mark.opencv_versions
@pytest.mark.parametrize(("name", "norm"), [("ORB", "HAM"), ("SIFT", "L2")])
def test_flann_keeps_what_both_directions_agree_on(
    described: dict[str, tuple[Features, Features]], name: str, norm: str
) -> None:
    matcher = make_matcher(opencv_methods(), "FLANN", norm)
    cv2.setRNGSeed(0)
    raw = matcher.call(*described[name])
    forth = {(match.queryIdx, match.trainIdx) for match in raw[0]}
    back = {(match.trainIdx, match.queryIdx) for match in raw[1]}
    got = {(int(i), int(j)) for i, j in matcher.read(raw).indices}
    assert got == forth & back


@pytest.mark.opencv_versions
@pytest.mark.parametrize("name", ["BF", "FLANN"])
@pytest.mark.parametrize("norm", ["L2", "HAM"])
def test_single_features_match_each_other_or_nothing(name: str, norm: str) -> None:
    one = np.full((1, 32), 7, np.uint8 if norm == "HAM" else np.float32)
    matches = match(name, norm, one, one)
    # The hash tables of LSH may leave a query without an answer; never with a wrong one.
    assert matches.indices.tolist() in ([[0, 0]], [])
    if name == "BF":
        assert len(matches) == 1


@pytest.mark.opencv_versions
def test_bits_without_any_likeness_are_handled() -> None:
    zeros, ones = np.zeros((20, 32), np.uint8), np.full((20, 32), 255, np.uint8)
    matches = match("FLANN", "HAM", zeros, ones)
    assert len(matches) <= 1
    assert len(match("BF", "HAM", zeros, ones)) == 1


def with_matcher(**change: Any) -> Methods:
    """OpenCV's methods and one row more: FLANN under another name, changed."""
    methods = opencv_methods()
    row = replace(methods.matchers["FLANN"], name="THIRD", **change)
    return replace(methods, matchers={**methods.matchers, "THIRD": row})


@pytest.mark.opencv_versions
def test_one_more_row_is_one_more_matcher() -> None:
    trees = {"algorithm": 1, "trees": 1}
    hasty = with_matcher(parameters={"L2": {**trees, "checks": 2}})
    patient = with_matcher(parameters={"L2": {**trees, "checks": 2000}})
    random = np.random.default_rng(5)
    first, second = random.normal(size=(2, 600, 32)).astype(np.float32)
    cv2.setRNGSeed(0)
    hasty_matches = match("THIRD", "L2", first, second, hasty)
    cv2.setRNGSeed(0)
    patient_matches = match("THIRD", "L2", first, second, patient)
    exact = mutual_neighbours(distances(first, second, "L2"))
    assert [tuple(pair) for pair in patient_matches.indices.tolist()] == exact
    assert len(hasty_matches) != len(exact)
    assert Combination.parse("SIFT-SIFT-L2-THIRD") in select(patient, "SIFT-*-THIRD")
    recorded = patient.parameters(Combination.parse("SIFT-SIFT-L2-THIRD"))["matcher"]
    assert recorded == ["opencv", "THIRD", {**trees, "checks": 2000}]


def test_a_row_without_search_parameters_takes_those_of_opencv() -> None:
    methods = with_matcher(parameters={"L2": {"algorithm": 1, "trees": 4}})
    one = np.eye(8, dtype=np.float32)
    assert len(match("THIRD", "L2", one, one, methods)) == 8


def test_a_norm_is_one_row_with_its_constant() -> None:
    methods = opencv_methods()
    brute_force = methods.matchers["BF"]
    row = replace(
        brute_force,
        parameters={**brute_force.parameters, "L1": {}},
        dtypes={**brute_force.dtypes, "L1": ("float32",)},
    )
    methods = replace(
        methods,
        norms={**methods.norms, "L1": NormRow("L1", "NORM_L1", "sum of absolute differences")},
        matchers={**methods.matchers, "BF": row},
    )
    first, second = np.array([[0, 0]], np.float32), np.array([[3, 4]], np.float32)
    assert match("BF", "L1", first, second, methods).distance.tolist() == [7]
    assert match("BF", "L2", first, second, methods).distance.tolist() == [5]


def test_what_a_row_names_must_be_known() -> None:
    with pytest.raises(MethodUnavailableError, match="'Guess'"):
        make_matcher(with_matcher(factory="Guess"), "THIRD", "L2")
    methods = opencv_methods()
    lost = replace(methods, norms={"L2": NormRow("L2", "NORM_OF_NOBODY", "")})
    with pytest.raises(MethodUnavailableError, match="NORM_OF_NOBODY"):
        make_matcher(lost, "BF", "L2")
    odd = with_matcher(factory="BFMatcher", parameters={"L2": {"speed": 3}})
    with pytest.raises(MethodUnavailableError, match="speed"):
        make_matcher(odd, "THIRD", "L2")
