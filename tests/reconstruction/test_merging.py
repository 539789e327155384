"""Positions of several pairs become keypoints, by hand."""

from __future__ import annotations

import numpy as np

from aerocues.methods.arrays import Features, Keypoints, Matches
from aerocues.pipeline.whole_images import MatchedPair
from aerocues.reconstruction.merging import merged


def pair(first: list[list[float]], second: list[list[float]], scores: list[float]) -> MatchedPair:
    features = [
        Features(Keypoints.from_xy(np.array(xy).reshape(-1, 2)), np.empty((len(xy), 0), np.float32))
        for xy in (first, second)
    ]
    indices = np.repeat(np.arange(len(scores), dtype=np.int32)[:, None], 2, axis=1)
    matches = Matches(indices, -np.array(scores, np.float32))
    return MatchedPair((features[0], features[1]), matches)


def test_positions_in_one_cell_are_one_keypoint_of_all_pairs() -> None:
    keypoints, pairs = merged(
        ["a", "b", "c", "d"],
        {
            ("a", "b"): pair([[10.0, 5.0], [2.0, 2.0]], [[20.0, 20.0], [7.0, 7.0]], [1, 1]),
            ("c", "b"): pair([[30.0, 1.0]], [[20.2, 19.8]], [1]),
            ("a", "c"): pair([[9.6, 5.4]], [[30.4, 1.2]], [1]),
        },
    )
    assert {name: len(each) for name, each in keypoints.items()} == {"a": 2, "b": 2, "c": 1, "d": 0}
    number = int(pairs["c", "b"].indices[0, 1])
    assert np.allclose(keypoints["b"].xy[number], [20.1, 19.9])
    assert number in pairs["a", "b"].indices[:, 1]
    in_a = int(pairs["a", "c"].indices[0, 0])
    assert np.allclose(keypoints["a"].xy[in_a], [9.8, 5.2])
    assert [in_a, number] in pairs["a", "b"].indices.tolist()
    assert np.allclose(keypoints["c"].xy, [[30.2, 1.1]])


def test_of_matches_that_share_a_keypoint_the_surest_stays() -> None:
    keypoints, pairs = merged(
        ["a", "b"],
        {
            ("a", "b"): pair(
                [[5.0, 5.0], [5.1, 5.0], [9.0, 9.0]],
                [[1.0, 1.0], [3.0, 3.0], [3.2, 3.0]],
                [0.2, 0.9, 0.5],
            )
        },
    )
    [[first, second]] = pairs["a", "b"].indices.tolist()
    assert np.allclose(keypoints["a"].xy[first], [5.05, 5.0])
    assert np.allclose(keypoints["b"].xy[second], [3.1, 3.0])
    assert pairs["a", "b"].distance.tolist() == [np.float32(-0.9)]
