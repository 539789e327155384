from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from aerocues.datasets.dataset import PinholeCamera, TrueView
from aerocues.datasets.true_geometry import Located, find_seen, inverse_depths, project

CAMERA = PinholeCamera(100, 80, 50.0, 50.0, 49.5, 39.5)
DOWN = np.diag([1.0, -1.0, -1.0])


@dataclass(frozen=True)
class Depth:
    """Depth from memory."""

    values: NDArray[np.float32] = field(repr=False)

    def read(self) -> NDArray[np.float32]:
        return self.values

    def content_key(self) -> str:
        return str(hash(self.values.tobytes()))


def view_from(
    east: float, height: float = 10.0, depth: NDArray[np.float32] | None = None
) -> Located:
    """A camera that looks straight down on level ground, its columns to the east."""
    ground = np.full((80, 100), height, np.float32) if depth is None else depth
    return Located.of(TrueView(CAMERA, DOWN, np.array([east, 0.0, height]), Depth(ground)))


def test_a_point_of_level_ground_moves_by_the_baseline_over_the_height() -> None:
    here, there = view_from(0), view_from(2)
    near, far = inverse_depths(np.array([[60.0, 30.0]]), here.inverse)
    assert near == far == pytest.approx(0.1)
    moved, inverse = project(np.array([[60.0, 30.0]]), near, here.view, there.view)
    # 2 m east of the ground is 2 / 10 * 50 = 10 pixels to the left in the other image.
    np.testing.assert_allclose(moved, [[50.0, 30.0]])
    np.testing.assert_allclose(inverse, [0.1])


def test_inverse_depth_between_pixels_of_a_slope_is_exact() -> None:
    # A plane z = 10 / (1 + 0.002 x): its inverse depth is linear in the column.
    columns = np.arange(100, dtype=np.float32)
    depth = np.tile(10 / (1 + 0.002 * columns), (80, 1)).astype(np.float32)
    inverse = view_from(0, depth=depth).inverse
    near, far = inverse_depths(np.array([[20.25, 3.5], [-0.4, 0.0], [99.3, 79.4]]), inverse)
    np.testing.assert_allclose(near, (1 + 0.002 * np.array([20.25, 0, 99])) / 10, rtol=1e-6)
    np.testing.assert_allclose(near, far)


def test_a_point_on_an_edge_has_both_depths() -> None:
    depth = np.full((80, 100), 10.0, np.float32)
    depth[:, 50:] = 6.0
    near, far = inverse_depths(np.array([[49.5, 40.0]]), view_from(0, depth=depth).inverse)
    np.testing.assert_allclose((1 / near, 1 / far), [[6.0], [10.0]], rtol=1e-6)


def test_what_is_outside_or_hidden_is_not_seen() -> None:
    roof = np.full((80, 100), 10.0, np.float32)
    roof[:, 40:60] = 5.0  # as the second camera sees it, from columns 40 to 59
    here, there = view_from(0), view_from(2, depth=roof)
    points = np.array([[5.0, 40.0], [55.0, 40.0], [75.0, 40.0]])
    moved, seen = find_seen(points, here, there)
    assert seen.tolist() == [False, False, True]
    np.testing.assert_allclose(moved[2], [65.0, 40.0])
    assert np.isnan(moved[:2]).all()


def test_the_sky_lies_where_it_lies_for_a_camera_that_only_moved() -> None:
    sky = np.full((80, 100), np.inf, np.float32)
    here, there = view_from(0, depth=sky), view_from(7, depth=sky)
    moved, seen = find_seen(np.array([[12.0, 34.0]]), here, there)
    assert seen.all()
    np.testing.assert_allclose(moved, [[12.0, 34.0]])


def test_unknown_depth_is_seen_nowhere() -> None:
    unknown = np.full((80, 100), np.nan, np.float32)
    moved, seen = find_seen(np.array([[50.0, 40.0]]), view_from(0, depth=unknown), view_from(0))
    assert not seen.any()
    assert np.isnan(moved).all()


@given(st.floats(-3, 3), st.floats(8, 14), st.integers(0, 2**32 - 1))
def test_there_and_back_is_where_it_was(east: float, height: float, seed: int) -> None:
    points = np.random.default_rng(seed).uniform((5, 5), (94, 74), (20, 2))
    here, there = view_from(0), view_from(east, height)
    moved, seen = find_seen(points, here, there)
    back, again = find_seen(moved[seen], there, here)
    assert again.all()
    np.testing.assert_allclose(back, points[seen], atol=1e-6)
