from __future__ import annotations

import re
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from aerocues.datasets.dataset import GpsPosition, Image, Pixels
from aerocues.datasets.gps import east_north_up
from aerocues.datasets.pairing import (
    Consecutive,
    Exhaustive,
    GpsNeighbours,
    PairsFile,
    parse_pairs,
    parse_pairs_file,
)
from aerocues.errors import DatasetError


class NoSource:
    def read(self) -> Pixels:
        raise AssertionError("pairing needs no pixels")

    def content_key(self) -> str:
        raise AssertionError("pairing needs no content")

    def is_gray(self) -> bool:
        raise AssertionError("pairing needs no header")


def images(count: int, positions: list[tuple[float, float]] | None = None) -> list[Image]:
    gps = [None] * count if positions is None else [GpsPosition(*place) for place in positions]
    return [Image(f"{i}.jpg", NoSource(), place) for i, place in enumerate(gps)]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("consecutive", Consecutive()),
        ("Consecutive:3", Consecutive(3)),
        ("exhaustive", Exhaustive()),
        ("gps", GpsNeighbours()),
        ("gps:4", GpsNeighbours(4)),
        ("gps:25.5m", GpsNeighbours(radius=25.5)),
    ],
)
def test_forms_of_pairs(text: str, expected: Any) -> None:
    assert parse_pairs(text) == expected


@pytest.mark.parametrize(
    "text", ["", "consecutive:0", "gps:", "gps:m", "exhaustive:2", "nowhere.txt"]
)
def test_other_forms_are_refused_with_the_known_ones(text: str) -> None:
    with pytest.raises(DatasetError, match="exhaustive"):
        parse_pairs(text)


@given(count=st.integers(2, 12), neighbours=st.integers(1, 15))
def test_consecutive_takes_all_pairs_up_to_a_distance(count: int, neighbours: int) -> None:
    pairs = Consecutive(neighbours).pairs(images(count))
    expected = {(i, j) for i, j in combinations(range(count), 2) if j - i <= neighbours}
    assert {(int(a[:-4]), int(b[:-4])) for a, b in pairs} == expected
    assert len(pairs) == len(expected)


def test_exhaustive() -> None:
    assert Exhaustive().pairs(images(3)) == [
        ("0.jpg", "1.jpg"),
        ("0.jpg", "2.jpg"),
        ("1.jpg", "2.jpg"),
    ]


# Within 200 m, so that no position is far from the others.
coordinates = st.tuples(st.floats(46.0, 46.001), st.floats(-92.0, -91.999))


@given(
    positions=st.lists(coordinates, min_size=3, max_size=9, unique=True), nearest=st.integers(1, 4)
)
def test_gps_neighbours_agree_with_a_search_by_hand(
    positions: list[tuple[float, float]], nearest: int
) -> None:
    local = east_north_up([GpsPosition(*place) for place in positions])[:, :2]
    distance = np.linalg.norm(local[:, None] - local[None], axis=2)
    np.fill_diagonal(distance, np.inf)
    found = {
        (int(a[:-4]), int(b[:-4]))
        for a, b in GpsNeighbours(nearest).pairs(images(len(positions), positions))
    }
    count = min(nearest, len(positions) - 1)
    for i, row in enumerate(distance):
        own = sorted(row[j] for pair in found if i in pair for j in pair if j != i)
        assert own[:count] == pytest.approx(sorted(row)[:count])
    assert all(i < j for i, j in found)


def test_gps_radius() -> None:
    scene = images(3, [(46.0, -92.0), (46.0001, -92.0), (46.001, -92.0)])  # 11 m and 100 m apart
    assert GpsNeighbours(radius=20).pairs(scene) == [("0.jpg", "1.jpg")]
    with pytest.raises(DatasetError, match="radius"):
        GpsNeighbours(radius=5).pairs(scene)


def test_gps_needs_positions() -> None:
    with pytest.raises(DatasetError, match=r"3 of 3 images .*GPS.*\(0\.jpg"):
        GpsNeighbours().pairs(images(3))


def test_pairs_file_with_comments_quotes_tabs_and_repeats(tmp_path: Path) -> None:
    file = tmp_path / "pairs.txt"
    text = '\ufeff# my pairs\r\n0.jpg 1.jpg  # near\n\n"my image.jpg"  2.jpg\nmy image.jpg\t0.jpg\n'
    file.write_text(text + "0.jpg 1.jpg\n1.jpg 0.jpg\n", encoding="utf-8")
    scene = [*images(3), Image("my image.jpg", NoSource())]
    assert PairsFile(file).pairs(scene) == [
        ("0.jpg", "1.jpg"),
        ("my image.jpg", "2.jpg"),
        ("my image.jpg", "0.jpg"),
        ("1.jpg", "0.jpg"),
    ]
    assert parse_pairs(str(file)) == PairsFile(file)


def test_pairs_file_names_what_is_wrong_and_where() -> None:
    text = "a.jpg b.jpg\na.jpg c.jgp\na.jpg\nb.jpg b.jpg\n"
    with pytest.raises(DatasetError) as caught:
        parse_pairs_file(text, ["a.jpg", "b.jpg", "c.jpg"], "my.txt")
    message = str(caught.value)
    assert re.search(
        r"my\.txt .*3 .*line 2: .*'c\.jgp'.*'c\.jpg'.*line 3: 1 name.* 2.*line 4: ", message, re.S
    )


@pytest.mark.parametrize("text", ["", "# nothing\n\n"])
def test_an_empty_pairs_file_is_refused(text: str) -> None:
    with pytest.raises(DatasetError, match="no pairs"):
        parse_pairs_file(text, ["a", "b"])


def test_pairs_file_that_is_no_text(tmp_path: Path) -> None:
    file = tmp_path / "pairs.bin"
    file.write_bytes(b"\xff\xfe\x00\xd8")
    with pytest.raises(DatasetError, match="UTF-8"):
        PairsFile(file).pairs(images(2))
    with pytest.raises(DatasetError, match=r"gone\.txt"):
        PairsFile(tmp_path / "gone.txt").pairs(images(2))


names = st.lists(
    st.from_regex(r"[a-z][a-z0-9_/.-]{0,8}", fullmatch=True), min_size=2, max_size=6, unique=True
)


@given(names=names, data=st.data())
def test_pairs_file_round_trip(names: list[str], data: st.DataObject) -> None:
    possible = [(a, b) for a in names for b in names if a != b]
    chosen = data.draw(st.lists(st.sampled_from(possible), min_size=1, unique=True))
    separator = data.draw(st.sampled_from([" ", "\t", "   "]))
    lines = [separator.join(pair) for pair in chosen]
    assert parse_pairs_file("\n".join(lines), names) == chosen


@given(text=st.text(max_size=80))
def test_any_text_gives_known_pairs_or_a_clear_error(text: str) -> None:
    try:
        pairs = parse_pairs_file(text, ["a", "b"])
    except DatasetError as caught:
        pairs, message = [], str(caught)
    else:
        message = ""
    assert pairs or re.search(r"line \d+|no pairs", message)
    assert set(pairs) <= {("a", "b"), ("b", "a")}
