"""Files of OpenMVG and Bundler, which list the matches of each pair, read as their source does."""

from __future__ import annotations

import gzip
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from aerocues.exports.flight import Flight
from aerocues.exports.match_lists import match_list
from tests.exports.written_flight import written, xy_of
from tests.reconstruction.scenes import CAMERA


def read_match_list(file: Path) -> dict[tuple[int, int], list[list[int]]]:
    """As OpenMVG and Bundler read it."""
    words = iter(file.read_text().split())
    found = {}
    for word in words:
        pair = int(word), int(next(words))
        count = int(next(words))
        found[pair] = [[int(next(words)), int(next(words))] for _ in range(count)]
    return found


def check_match_list(flight: Flight, file: Path, matches: dict[Any, NDArray[np.int32]]) -> None:
    found = read_match_list(file)
    assert len(found) == len(matches)
    for (one, two), rows in found.items():
        assert one < two
        names = flight.images[one], flight.images[two]
        expected = matches.get(names)
        if expected is None:
            expected = matches[names[1], names[0]][:, ::-1]
        assert rows == expected.tolist()


@pytest.mark.slow
def test_openmvg_finds_regions_and_matches(flight: Flight, tmp_path: Path) -> None:
    [command] = written(flight, "openmvg", tmp_path / "out")
    place = tmp_path / "out" / "matches"
    assert str(place / "matches.f.txt") in command
    views = json.loads((tmp_path / "out" / "sfm_data.json").read_text())
    data = [view["value"]["ptr_wrapper"]["data"] for view in views["views"]]
    assert [each["filename"] for each in data] == flight.images
    [camera] = views["intrinsics"]
    inner = camera["value"]["ptr_wrapper"]["data"]
    assert inner["focal_length"] == CAMERA.focal_x
    assert inner["principal_point"] == [CAMERA.centre_x, CAMERA.centre_y]
    for name in flight.images:
        rows = np.loadtxt(place / f"{Path(name).stem}.feat", np.float32, ndmin=2)
        np.testing.assert_array_equal(rows[:, :2], xy_of(flight, name))
        content = (place / f"{Path(name).stem}.desc").read_bytes()
        assert int.from_bytes(content[:8], "little") == len(rows)
        length = 128 if flight.combination.descriptor == "SIFT" else 64
        descriptors = np.frombuffer(content[8:], np.uint8).reshape(len(rows), length)
        np.testing.assert_array_equal(descriptors, flight.descriptors(name))
    putative = {names: each.indices for names, each in flight.linked.pairs.items()}
    check_match_list(flight, place / "matches.putative.txt", putative)
    check_match_list(flight, place / "matches.f.txt", dict(flight.verified))


@pytest.mark.slow
def test_bundler_finds_keys_and_matches(flight: Flight, tmp_path: Path) -> None:
    [command] = written(flight, "bundler", tmp_path / "out")
    assert command.startswith(f"cd {tmp_path / 'out'}")
    lines = (tmp_path / "out" / "list.txt").read_text().splitlines()
    assert [line.split() for line in lines] == [[name, "0", "420"] for name in flight.images]
    for name in flight.images:
        file = (tmp_path / "out" / name).with_suffix(".key.gz")
        words = gzip.decompress(file.read_bytes()).split()
        count, length = int(words[0]), int(words[1])
        assert (count, length) == (len(xy_of(flight, name)), 128)
        rows = np.array(words[2:], np.float64).reshape(count, 4 + length)
        np.testing.assert_array_equal(rows[:, 1::-1].astype(np.float32), xy_of(flight, name))
        if flight.combination.descriptor == "SIFT":
            np.testing.assert_array_equal(rows[:, 4:], flight.descriptors(name))
    check_match_list(flight, tmp_path / "out" / "matches.init.txt", dict(flight.verified))


def test_lists_of_matches_begin_with_the_lower_number() -> None:
    matches = {("b", "a"): np.array([[1, 2], [3, 4]], np.int32)}
    assert match_list(["a", "b"], matches) == "0 1\n2\n2 1\n4 3\n"
