"""Similarities against COLMAP's own and by hand."""

from __future__ import annotations

import numpy as np
import pycolmap
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from aerocues.reconstruction.alignment import (
    Similarity,
    extent,
    robust_similarity,
    root_mean_square,
    rotation_angles,
    similarity,
)


@given(st.integers(0, 10_000))
def test_a_similarity_that_was_applied_is_found_again(seed: int) -> None:
    generator = np.random.default_rng(seed)
    points = generator.normal(size=(6, 3)) * 50
    rotation = Rotation.random(random_state=seed).as_matrix()
    truth = Similarity(float(generator.uniform(0.01, 100)), rotation, generator.normal(size=3))
    found = similarity(points, truth.apply(points))
    assert found is not None
    assert found.scale == pytest.approx(truth.scale)
    np.testing.assert_allclose(found.rotation, rotation, atol=1e-8)
    np.testing.assert_allclose(found.apply(points), truth.apply(points), rtol=1e-8, atol=1e-8)


def test_noisy_points_give_what_colmap_gives() -> None:
    generator = np.random.default_rng(3)
    source = generator.normal(size=(20, 3))
    target = 4 * source @ Rotation.random(random_state=1).as_matrix().T + [1, 2, 3]
    target += generator.normal(scale=0.3, size=target.shape)
    found, theirs = similarity(source, target), pycolmap.estimate_sim3d(source, target)
    assert found is not None
    assert theirs is not None
    assert found.scale == pytest.approx(theirs.scale)
    np.testing.assert_allclose(found.rotation, theirs.rotation.matrix(), atol=1e-9)
    np.testing.assert_allclose(found.translation, theirs.translation, atol=1e-9)


@pytest.mark.parametrize("count", [9, 60])
def test_cameras_that_are_far_off_do_not_bend_the_frame(count: int) -> None:
    generator = np.random.default_rng(4)
    source = generator.normal(size=(count, 3))
    target = 30 * source @ Rotation.random(random_state=5).as_matrix().T + [7, 8, 9]
    target += generator.normal(scale=0.2, size=target.shape)
    target[: count // 3] += [40, 0, 0]
    found = robust_similarity(source, target, tolerance=2.0)
    assert found is not None
    errors = np.linalg.norm(found.apply(source) - target, axis=1)
    assert errors[: count // 3].min() > 30
    assert errors[count // 3 :].max() < 1
    again = robust_similarity(source, target, tolerance=2.0)
    assert again is not None
    np.testing.assert_array_equal(found.rotation, again.rotation)


def test_a_mirrored_scene_is_not_mirrored_back() -> None:
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]])
    found = similarity(points, points * [1, 1, -1])
    assert found is not None
    assert np.linalg.det(found.rotation) == pytest.approx(1)


@pytest.mark.parametrize(
    "points",
    [
        np.zeros((0, 3)),
        np.array([[0.0, 0, 0], [1, 1, 1]]),
        np.outer(np.arange(5.0), [1, 2, 3]),
        np.ones((4, 3)),
    ],
    ids=["none", "two", "on a line", "all the same"],
)
def test_what_does_not_determine_it_gives_none(points: np.ndarray) -> None:
    assert similarity(points, points) is None
    assert robust_similarity(points, points, tolerance=1.0) is None


def test_extent_and_root_mean_square_by_hand() -> None:
    assert extent(np.array([[0.0, 0, 0], [3, 0, 1], [1, 4, 0]])) == pytest.approx(26**0.5)
    assert root_mean_square(np.array([1.0, 2, 2])) == pytest.approx(3**0.5)


def test_angles_between_rotations() -> None:
    turned = Rotation.from_euler("z", [[0], [30], [180]], degrees=True).as_matrix()
    found = rotation_angles(turned, np.repeat(np.eye(3)[None], 3, axis=0))
    np.testing.assert_allclose(found, [0, 30, 180], atol=1e-5)
