"""Keypoints that a pair matcher guides, against a known map of the plane."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from aerocues.methods.arrays import Float32Array, Keypoints
from aerocues.methods.pair_matching import PointMatches
from aerocues.pipeline.guiding import guided_matches, transferred

TURN = np.array([[-0.9, 0.3], [-0.3, -0.9]])


def moved(xy: NDArray[np.floating]) -> Float32Array:
    return np.asarray(xy @ TURN.T + [300, 200], np.float32)


def grid() -> PointMatches:
    y, x = np.mgrid[0:160:8, 0:160:8]
    first = np.stack([x.ravel(), y.ravel()], axis=1).astype(np.float32)
    return PointMatches(first, moved(first), np.zeros(len(first), np.float32))


def test_an_affine_map_is_followed_exactly_and_nothing_is_told_far_away() -> None:
    found, points = grid(), np.random.default_rng(0).uniform(0, 152, (50, 2)).astype(np.float32)
    assert np.allclose(
        transferred(points, found.points_1, found.points_2), moved(points), atol=0.01
    )
    far = np.array([[400, 400]], np.float32)
    assert np.isnan(transferred(far, found.points_1, found.points_2)).all()


def test_keypoints_are_matched_where_both_ways_agree_within_two_pixels() -> None:
    first = np.array([[40, 40], [80, 80], [81, 80], [120, 40]], np.float32)
    second = moved(first) + np.array([[1, 1], [0, 0], [30, 0], [0, 2.5]], np.float32)
    matches = guided_matches(grid(), Keypoints.from_xy(first), Keypoints.from_xy(second[::-1]))
    assert matches.indices.tolist() == [[0, 3], [1, 2]]
    assert np.allclose(matches.distance, [np.sqrt(2), 0], atol=0.01)


def test_without_positions_or_keypoints_there_is_nothing() -> None:
    some, none = Keypoints.from_xy(np.ones((3, 2))), Keypoints.from_xy(np.empty((0, 2)))
    assert len(guided_matches(grid().take(np.arange(3)), some, some)) == 0
    assert len(guided_matches(grid(), none, some)) == 0
