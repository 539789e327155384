"""What a reconstruction is put together from: graphs, files of matches, diagnoses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from aerocues.datasets.dataset import Dataset, GpsPosition, Image
from aerocues.datasets.decoding import FileSource
from aerocues.methods.arrays import Keypoints
from aerocues.reconstruction.alignment import Similarity
from aerocues.reconstruction.diagnosis import (
    judged,
    without_features,
    without_links,
)
from aerocues.reconstruction.match_graph import parts_of, told_parts
from aerocues.reconstruction.matched_scene import MatchedScene, PairMatches, read_matched_scene
from aerocues.reconstruction.protocol import Requirements
from aerocues.reconstruction.truth import Located, TruePositions, locate, true_positions

IMAGES = ["a", "b", "c", "d", "e", "f"]
WHOLE = {("a", "b"): 200, ("b", "c"): 80, ("c", "d"): 40, ("d", "e"): 30, ("e", "f"): 20}


def test_parts_of_a_graph() -> None:
    assert parts_of(IMAGES, [("e", "d"), ("d", "c"), ("a", "b")]) == [
        ["c", "d", "e"],
        ["a", "b"],
        ["f"],
    ]
    assert parts_of(["a"], []) == [["a"]]


def test_parts_in_words() -> None:
    assert told_parts([["a", "b", "c", "d"], ["e", "f"], ["g"], ["h"]]) == (
        "4 parts: 4 images (a, b, c, ...), 2 images (e, f), 2 without links (g, h)"
    )


def keypoints(responses: list[float]) -> Keypoints:
    count = len(responses)
    found = Keypoints.from_xy(np.arange(2.0 * count).reshape(count, 2))
    return Keypoints(**{**vars(found), "response": np.array(responses, np.float32)})


def matched() -> MatchedScene:
    pairs = {
        ("a", "b"): PairMatches(np.array([[0, 1], [2, 0]], np.int32), np.array([3, 4], np.float32)),
        ("a", "c"): PairMatches(np.empty((0, 2), np.int32), np.empty(0, np.float32)),
    }
    found = {"a": keypoints([1, 2, 3]), "b": keypoints([1, 2]), "c": keypoints([])}
    return MatchedScene(found, pairs, 1.25, 2.5)


def test_matches_are_read_as_they_were_written(tmp_path: Path) -> None:
    file = tmp_path / "matches.npz"
    matched().write(file, "key")
    read = read_matched_scene(file, "key")
    assert read is not None
    assert (read.feature_seconds, read.matching_seconds) == (1.25, 2.5)
    assert {name: len(found) for name, found in read.keypoints.items()} == {"a": 3, "b": 2, "c": 0}
    assert list(read.pairs) == [("a", "b"), ("a", "c")]
    for pair, matches in matched().pairs.items():
        np.testing.assert_array_equal(read.pairs[pair].indices, matches.indices)
    first, second = read.points(("a", "b"))
    np.testing.assert_array_equal(first, [[0, 1], [4, 5]])
    np.testing.assert_array_equal(second, [[2, 3], [0, 1]])


@pytest.mark.parametrize("size", [0, 10, 300])
def test_damaged_or_other_matches_do_not_count(tmp_path: Path, size: int) -> None:
    file = tmp_path / "matches.npz"
    assert read_matched_scene(file, "key") is None
    matched().write(file, "key")
    assert read_matched_scene(file, "another key") is None
    file.write_bytes(file.read_bytes()[:size])
    assert read_matched_scene(file, "key") is None


def test_failures_before_the_mapper_are_told_in_words() -> None:
    outcome = without_features({"a": 0, "b": 7, "c": 0})
    assert outcome is not None
    assert (outcome.status, outcome.message) == ("no_features", "2 of 3 images have no keypoints")
    assert without_features({"a": 3, "b": 7}) is None
    outcome = without_links(15, 0, 0, chance=True)
    assert outcome is not None
    assert outcome.message == "none of 15 pairs has matches that beat chance"
    outcome = without_links(15, 4, 0, chance=True)
    assert outcome is not None
    assert outcome.message == "COLMAP verified none of 4 pairs with matches that beat chance"
    outcome = without_links(15, 0, 0, chance=False)
    assert outcome is not None
    assert outcome.message == "none of 15 pairs has enough matches"
    assert without_links(15, 4, 2, chance=True) is None


def test_an_incomplete_model_tells_the_parts_or_what_is_left_out() -> None:
    torn = {pair: count for pair, count in WHOLE.items() if pair != ("c", "d")}
    outcome = judged(IMAGES, ["a", "b", "c"], torn, None, Requirements())
    assert outcome.status == "incomplete"
    assert outcome.message == (
        "the model has 3 of 6 images; the graph of verified pairs consists of 2 parts: "
        "3 images (a, b, c), 3 images (d, e, f)"
    )
    outcome = judged(IMAGES, ["a", "b", "c", "d"], WHOLE, None, Requirements())
    assert outcome.status == "incomplete"
    assert outcome.message == (
        "the model has 4 of 6 images, although the graph of verified pairs is connected; missing: "
        "e (2 pairs, at most 30 inliers), f (1 pairs, at most 20 inliers)"
    )
    assert judged(IMAGES, IMAGES[:5], WHOLE, None, Requirements()).status == "ok"
    assert judged(IMAGES, IMAGES, WHOLE, None, Requirements()).message is None


def located(errors: dict[str, float]) -> Located:
    """Cameras that are so many metres too far east, of which 5 are allowed."""
    differences = {name: np.array([error, 0.0, 0.0]) for name, error in errors.items()}
    truth = TruePositions("gps", dict.fromkeys(errors, np.zeros(3)))
    frame = Similarity(1.0, np.eye(3), np.zeros(3))
    return Located(truth, frame, differences, np.array([5.0, 5.0, 10.0]))


def test_a_model_with_cameras_far_from_their_place() -> None:
    near = dict.fromkeys(IMAGES, 0.7)
    outcome = judged(IMAGES, IMAGES, WHOLE, located({**near, "b": 23.14}), Requirements())
    assert outcome.status == "ok"
    assert outcome.message == (
        "1 of 6 cameras is more than 5.0 m from its true position (gps): b (23.1 m)"
    )
    far = located({**near, "b": 23.14, "d": 30.0})
    outcome = judged(IMAGES, IMAGES, WHOLE, far, Requirements())
    assert outcome.status == "misplaced"
    assert outcome.message == (
        "2 of 6 cameras are more than 5.0 m from their true positions (gps): d (30.0 m), "
        "b (23.1 m); the model is bent or wrongly joined"
    )
    assert judged(IMAGES, IMAGES, WHOLE, located(near), Requirements()).message is None


def test_images_without_a_position_do_not_count_as_in_their_place() -> None:
    found = located({"a": 0.5, "b": 0.4, "c": 20.0})
    truth = TruePositions("gps", found.truth.by_name, dict.fromkeys("def", "no altitude"))
    outcome = judged(IMAGES, IMAGES, WHOLE, replace(found, truth=truth), Requirements())
    assert outcome.status == "misplaced"


def flight(positions: Sequence[GpsPosition | None]) -> Dataset:
    located = zip(IMAGES, positions, strict=False)
    images = [Image(name, FileSource(Path(name)), each) for name, each in located]
    return Dataset("flight", images, [], "epipolar")


FLOWN = [GpsPosition(47.6 + i * 2e-4, 9.3 + (i % 2) * 3e-4, 480.0 + i) for i in range(6)]


def test_one_far_position_changes_neither_the_extent_nor_the_tolerance() -> None:
    clean = true_positions(flight(FLOWN[1:]))
    bent = true_positions(flight([*FLOWN[1:], GpsPosition(47.7, 9.3, 480.0)]))
    assert clean is not None
    assert bent is not None
    assert bent.left_out == {"f": "11.0 km from the others"}
    assert bent.extent == clean.extent
    np.testing.assert_array_equal(bent.tolerance(Requirements()), clean.tolerance(Requirements()))


def test_too_few_different_positions_are_no_truth() -> None:
    assert true_positions(flight([None] * 6)) is None
    for positions in ([FLOWN[0]] * 6, [*FLOWN[:2], None, None, None, None]):
        truth = true_positions(flight(positions))
        assert truth is not None
        assert not truth.known
        centres = dict(zip(IMAGES, np.eye(6, 3), strict=True))
        assert locate(centres, truth, Requirements()) is None
