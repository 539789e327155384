"""Exact matches against OpenCV's brute force, on all that makes distances equal or all but."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from aerocues.errors import AerocuesError
from aerocues.methods.arrays import Matches
from aerocues.methods.exact import brute_force, euclidean, hamming, matching
from tests.methods.brute_force import assert_equals_brute_force, exact

Random = np.random.Generator
SEEDS = st.integers(0, 2**32 - 1).map(np.random.default_rng)
COUNTS = st.integers(1, 60)


@pytest.fixture
def fast_ways(monkeypatch: pytest.MonkeyPatch) -> pytest.MonkeyPatch:
    """Leave nothing to OpenCV because it is small."""
    monkeypatch.setattr(matching, "FEWEST_PAIRS", 0)
    monkeypatch.setattr(euclidean, "pays", lambda *sizes: True)
    return monkeypatch


TILES = pytest.mark.parametrize("tiles", ["one tile", "many tiles"])


@contextmanager
def small_too(tiles: str) -> Iterator[None]:
    """The fast ways for small sets, which then fit into one tile, or do not."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(matching, "FEWEST_PAIRS", 0)
        patch.setattr(euclidean, "pays", lambda *sizes: True)
        if tiles == "many tiles":
            patch.setattr(euclidean, "TILE", 7)
            patch.setattr(hamming, "BLOCK", 5)
            patch.setattr(hamming, "ROWS_AT_ONCE", 11)
        yield


def noise(random: Random, count: int, columns: int) -> NDArray[np.float32]:
    return random.normal(size=(count, columns)).astype(np.float32)


def small_integers(random: Random, count: int, columns: int) -> NDArray[np.float32]:
    return random.integers(0, 3, (count, columns)).astype(np.float32)


def large_integers(random: Random, count: int, columns: int) -> NDArray[np.float32]:
    return random.integers(0, 256, (count, columns)).astype(np.float32)


def lengths_of_one(random: Random, count: int, columns: int) -> NDArray[np.float32]:
    vectors = np.abs(noise(random, count, columns)) + np.float32(1e-3)
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True), np.float32)


def far_from_zero(random: Random, count: int, columns: int) -> NDArray[np.float32]:
    """The squares that cancel each other are far larger than the distances."""
    return noise(random, count, columns) + np.float32(1000)


def sparse(random: Random, count: int, columns: int) -> NDArray[np.float32]:
    return noise(random, count, columns) * (random.random((count, columns)) < 0.1)


NUMBERS = st.sampled_from(
    [noise, small_integers, large_integers, lengths_of_one, far_from_zero, sparse]
)


def with_copies(random: Random, *sets: NDArray[Any]) -> list[NDArray[Any]]:
    """Sets in which some rows are those of the first set, or zero."""
    mixed = []
    for rows in sets:
        chosen = rows.copy()
        copied = random.random(len(rows)) < 0.4
        chosen[copied] = sets[0][random.integers(0, len(sets[0]), copied.sum())]
        chosen[random.random(len(rows)) < 0.1] = 0
        mixed.append(chosen)
    return mixed


def nudged(random: Random, rows: NDArray[np.float32]) -> NDArray[np.float32]:
    """Rows of which some numbers are the next larger ones: the last bit decides who is nearer."""
    larger = np.nextafter(rows, np.float32(np.inf))
    return np.where(random.random(rows.shape) < 0.2, larger, rows)


@TILES
@given(SEEDS, COUNTS, COUNTS, st.integers(1, 210), st.sampled_from([1, 3, 256]))
def test_bits(
    tiles: str, random: Random, first: int, second: int, columns: int, values: int
) -> None:
    sets = (random.integers(0, values, (n, columns)).astype(np.uint8) for n in (first, second))
    with small_too(tiles):
        one, other = with_copies(random, *sets)
        assert_equals_brute_force(one, other, "HAM")


@TILES
@given(SEEDS, COUNTS, COUNTS, st.integers(1, 210), NUMBERS, st.integers(-16, 15))
def test_numbers(
    tiles: str, random: Random, first: int, second: int, columns: int, make: Any, scale: int
) -> None:
    sets = (make(random, n, columns) * np.float32(10.0**scale) for n in (first, second))
    copied = with_copies(random, *sets)
    with small_too(tiles):
        assert_equals_brute_force(copied[0], nudged(random, copied[1]), "L2")


@TILES
@given(SEEDS, COUNTS, COUNTS, st.integers(1, 210), st.sampled_from([2, 50, 256]))
def test_bytes_as_numbers(
    tiles: str, random: Random, first: int, second: int, columns: int, values: int
) -> None:
    sets = (random.integers(0, values, (n, columns)).astype(np.uint8) for n in (first, second))
    with small_too(tiles):
        one, other = with_copies(random, *sets)
        assert_equals_brute_force(one, other, "L2")


def test_of_equally_near_ones_the_first_counts_both_ways(fast_ways: pytest.MonkeyPatch) -> None:
    first = np.array([[9, 9], [0, 0], [0, 0], [4, 4]], np.float32)
    second = np.array([[4, 5], [5, 4], [0, 0], [0, 0]], np.float32)
    for norm, dtype in (("L2", np.float32), ("L2", np.uint8), ("HAM", np.uint8)):
        matches = assert_equals_brute_force(first.astype(dtype), second.astype(dtype), norm)
        assert [1, 2] in matches.indices.tolist()


@pytest.mark.parametrize("columns", [16, 48, 200])
def test_what_products_of_matrices_get_wrong_is_put_right(
    fast_ways: pytest.MonkeyPatch, columns: int
) -> None:
    random = np.random.default_rng(columns)
    first = lengths_of_one(random, 300, columns)
    second = nudged(random, np.repeat(first, 3, axis=0))
    table = (second**2).sum(axis=1) - 2 * first @ second.T
    truly = cv2.batchDistance(first, second, cv2.CV_32F, normType=cv2.NORM_L2, K=1)[1][:, 0]
    assert (table.argmin(axis=1) != truly).any()
    assert_equals_brute_force(first, second, "L2")


def test_roots_that_round_to_the_same_number_tie(fast_ways: pytest.MonkeyPatch) -> None:
    # The first is farther by less than the root can show, and first all the same.
    first = np.zeros((1, 3), np.float32)
    second = np.array([[4098, 1, 1], [4098, 0, 0]], np.float32)
    squares = (second.astype(np.float64) ** 2).sum(axis=1)
    assert squares[0] > squares[1]
    assert len(np.unique(np.sqrt(squares.astype(np.float32)))) == 1
    assert assert_equals_brute_force(first, second, "L2").indices.tolist() == [[0, 0]]


@pytest.mark.parametrize(("norm", "dtype"), [("HAM", "uint8"), ("L2", "uint8"), ("L2", "float32")])
@pytest.mark.parametrize("sizes", [(1, 1), (1, 700), (700, 1), (513, 1030), (256, 257)])
def test_sizes_at_the_edges_of_tiles(
    fast_ways: pytest.MonkeyPatch, norm: str, dtype: str, sizes: tuple[int, int]
) -> None:
    random = np.random.default_rng(sizes[1])
    first, second = (random.integers(0, 256, (n, 33)).astype(dtype) for n in sizes)
    assert_equals_brute_force(first, second, norm)


@pytest.mark.parametrize(("norm", "dtype"), [("HAM", "uint8"), ("L2", "uint8"), ("L2", "float32")])
@pytest.mark.parametrize("sizes", [(0, 0), (0, 5), (5, 0)])
def test_nothing_matches_nothing(norm: str, dtype: str, sizes: tuple[int, int]) -> None:
    first, second = (np.zeros((n, 32), dtype) for n in sizes)
    matches = exact(first, second, norm)
    assert isinstance(matches, Matches)
    assert len(matches) == 0


@pytest.mark.parametrize(("norm", "dtype"), [("HAM", "uint8"), ("L2", "uint8"), ("L2", "float32")])
def test_what_is_small_is_left_to_opencv(
    monkeypatch: pytest.MonkeyPatch, norm: str, dtype: str
) -> None:
    for way in (hamming, euclidean):
        monkeypatch.setattr(way, "nearest_both_ways", None)
    random = np.random.default_rng(3)
    first, second = random.integers(0, 256, (2, 40, 32)).astype(dtype)
    assert_equals_brute_force(first, second, norm)


@pytest.mark.parametrize(
    "rows",
    [
        np.zeros((300, 40), np.float32),
        np.full((300, 40), 1e18, np.float32),
        np.full((300, 40), 1e-20, np.float32),
        np.ones((300, 40), np.float32),
    ],
)
def test_what_the_bound_cannot_tell_is_left_to_opencv(
    monkeypatch: pytest.MonkeyPatch, rows: NDArray[np.float32]
) -> None:
    asked: list[str] = []
    mutual = brute_force.mutual

    def told(first: Any, second: Any, norm: str) -> Matches:
        asked.append(norm)
        return mutual(first, second, norm)

    monkeypatch.setattr(brute_force, "mutual", told)
    assert_equals_brute_force(rows, rows, "L2")
    assert asked == ["L2"]


def test_descriptors_longer_than_a_key_holds_are_left_to_opencv() -> None:
    random = np.random.default_rng(1)
    first, second = random.integers(0, 256, (2, 50, 9000)).astype(np.uint8)
    assert_equals_brute_force(first, second, "HAM")
    assert_equals_brute_force(
        np.zeros((50, 8191), np.uint8), np.full((50, 8191), 255, np.uint8), "HAM"
    )


def test_rows_with_gaps_between_them_match_as_well(fast_ways: pytest.MonkeyPatch) -> None:
    random = np.random.default_rng(2)
    first, second = random.integers(0, 256, (2, 90, 80)).astype(np.uint8)[:, ::2, 7:40]
    assert_equals_brute_force(first, second, "HAM")
    assert_equals_brute_force(first, second, "L2")
    assert_equals_brute_force(
        first.astype(np.float32)[:, 3:], second.astype(np.float32)[:, 3:], "L2"
    )


@pytest.mark.parametrize(
    ("first", "second", "norm", "words"),
    [
        (np.ones((3, 4), np.float32), np.ones((3, 4), np.float32), "HAM", "uint8"),
        (np.ones((3, 4)), np.ones((3, 4)), "L2", "float64"),
        (np.ones((3, 4), np.uint8), np.ones((3, 5), np.uint8), "HAM", "compare"),
        (np.ones((3, 4), np.uint8), np.ones((3, 4), np.float32), "L2", "compare"),
        (np.ones((3, 4), np.uint8), np.ones((3, 4), np.uint8), "L1", "L1.* L2 or HAM"),
    ],
)
def test_what_cannot_be_compared_is_told(
    first: NDArray[Any], second: NDArray[Any], norm: str, words: str
) -> None:
    with pytest.raises(AerocuesError, match=words):
        exact(first, second, norm)


@pytest.mark.slow
@pytest.mark.parametrize(("norm", "dtype"), [("HAM", "uint8"), ("L2", "float32")])
@pytest.mark.parametrize("sizes", [(70_000, 900), (900, 70_000), (6000, 7000)])
def test_many(norm: str, dtype: str, sizes: tuple[int, int]) -> None:
    random = np.random.default_rng(sizes[0])
    first, second = (random.integers(0, 256, (n, 32)).astype(dtype) for n in sizes)
    assert len(assert_equals_brute_force(first, second, norm)) > 100
