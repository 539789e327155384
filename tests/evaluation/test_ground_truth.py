from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from aerocues.datasets.dataset import Pixels
from aerocues.evaluation.ground_truth import area_under_curve, corner_error
from aerocues.pipeline.correspondence import PlaneCorrespondence, covisible, transfer
from aerocues.pipeline.point_figures import repeatability as repeatability_by

IDENTITY = np.eye(3)


def shift(x: float, y: float) -> NDArray[np.float64]:
    return np.array([[1, 0, x], [0, 1, y], [0, 0, 1.0]])


def points(*xy: tuple[float, float]) -> NDArray[np.float32]:
    return np.array(xy, np.float32).reshape(-1, 2)


def blank(width: int = 100, height: int = 50, valid: NDArray[np.bool_] | None = None) -> Pixels:
    return Pixels(np.zeros((height, width, 3), np.uint8), valid)


def transfer_errors(
    points_1: NDArray[np.float32], points_2: NDArray[np.float32], homography: NDArray[np.float64]
) -> NDArray[np.float64]:
    return PlaneCorrespondence(homography, blank(), blank()).errors(points_1, points_2)


def repeatability(
    points_1: NDArray[np.float32],
    points_2: NDArray[np.float32],
    homography: NDArray[np.float64],
    pixels_1: Pixels,
    pixels_2: Pixels,
) -> float | None:
    truth = PlaneCorrespondence(homography, pixels_1, pixels_2)
    return repeatability_by(points_1, points_2, truth)


def test_points_are_mapped_and_divided() -> None:
    homography = np.array([[2, 0, 1], [0, 2, 3], [0, 0, 2.0]])
    np.testing.assert_allclose(transfer(points((4, 6)), homography), [[4.5, 7.5]])
    tilted = np.array([[1, 0, 0], [0, 1, 0], [-0.1, 0, 1.0]])
    moved = transfer(points((5, 1), (10, 1), (20, 1)), tilted)
    np.testing.assert_allclose(moved[0], (10, 2))
    assert np.isnan(moved[1:]).all()


def test_transfer_errors_are_pixels_of_image_2() -> None:
    errors = transfer_errors(points((0, 0), (1, 1)), points((10, 5), (14, 9)), shift(10, 5))
    np.testing.assert_allclose(errors, [0, 3 * np.sqrt(2)])
    behind = np.array([[1, 0, 0], [0, 1, 0], [-0.1, 0, 1.0]])
    assert transfer_errors(points((20, 1)), points((0, 0)), behind).tolist() == [np.inf]


def test_points_are_covisible_where_they_fall_on_valid_pixels() -> None:
    target = blank(20, 10)
    at = points((-0.5, 0), (-0.6, 0), (19.4, 9.4), (19.5, 5), (5, 9.5), (5, -0.5))
    assert covisible(at, IDENTITY, target).tolist() == [True, False, True, False, False, True]
    valid = np.ones((10, 20), bool)
    valid[3, 7] = False
    masked = blank(20, 10, valid)
    at = points((7, 3), (7.4, 3.4), (7.6, 3), (6, 3), (30, 3))
    assert covisible(at, IDENTITY, masked).tolist() == [False, False, True, True, False]


def test_points_behind_the_camera_are_not_covisible() -> None:
    behind = np.array([[1, 0, 0], [0, 1, 0], [-0.1, 0, 1.0]])
    assert covisible(points((20, 1), (1, 1)), behind, blank()).tolist() == [False, True]


def test_repeatability_is_the_share_found_again() -> None:
    first = points((10, 10), (20, 10), (30, 10), (40, 10))
    second = points((15, 10), (25, 12), (35, 14))
    # 0 px, 2 px and 4 px off after the shift by 5: two of min(4, 3).
    assert repeatability(first, second, shift(5, 0), blank(), blank()) == pytest.approx(2 / 3)


def test_repeatability_is_one_to_one() -> None:
    first = points((10, 10), (11, 10), (12, 10))
    second = points((11, 10.5), (60, 40), (70, 40))
    assert repeatability(first, second, IDENTITY, blank(), blank()) == pytest.approx(1 / 3)
    assert repeatability(second, first, IDENTITY, blank(), blank()) == pytest.approx(1 / 3)


def test_repeatability_counts_only_what_both_images_show() -> None:
    first = points((10, 10), (95, 10))
    second = points((30, 10), (5, 10))
    # Shifted by 20: (95, 10) leaves image 2, and (5, 10) was not in image 1.
    assert repeatability(first, second, shift(20, 0), blank(), blank()) == 1
    valid = np.ones((50, 100), bool)
    valid[:, 25:35] = False
    assert repeatability(first, second, shift(20, 0), blank(), blank(valid=valid)) is None


def test_repeatability_is_undefined_without_keypoints() -> None:
    assert repeatability(points(), points((1, 1)), IDENTITY, blank(), blank()) is None
    assert repeatability(points((1, 1)), points(), IDENTITY, blank(), blank()) is None
    assert repeatability(points((1, 1)), points((40, 40)), IDENTITY, blank(), blank()) == 0


@given(st.integers(1, 40), st.integers(0, 2**32 - 1))
def test_a_set_repeats_itself_wholly(count: int, seed: int) -> None:
    at = np.random.default_rng(seed).uniform((0, 0), (99, 49), (count, 2)).astype(np.float32)
    assert repeatability(at, at, IDENTITY, blank(), blank()) == 1


def test_corner_error_is_the_mean_over_the_corners() -> None:
    assert corner_error(IDENTITY, IDENTITY, blank()) == 0
    assert corner_error(shift(3, 4), IDENTITY, blank()) == pytest.approx(5)
    doubled = np.diag([2.0, 2.0, 1.0])
    corners = [0, 99, np.hypot(99, 49), 49]
    assert corner_error(doubled, IDENTITY, blank()) == pytest.approx(np.mean(corners))


@pytest.mark.parametrize("scale", [-1.0, 7.0, -0.01])
def test_corner_error_ignores_scale_and_sign_of_the_estimate(scale: float) -> None:
    assert corner_error(scale * shift(3, 4), IDENTITY, blank()) == pytest.approx(5)


def test_corner_error_without_a_usable_estimate_is_infinite() -> None:
    assert corner_error(None, IDENTITY, blank()) == np.inf
    # The vanishing line crosses the image: one corner goes through infinity.
    broken = np.array([[1, 0, 0], [0, 1, 0], [-0.015, 0, 1.0]])
    assert corner_error(broken, IDENTITY, blank()) == np.inf


@pytest.mark.parametrize(
    ("error", "limit", "area"), [(0, 3, 1), (1.5, 3, 0.5), (3, 3, 0), (9, 3, 0), (np.inf, 3, 0)]
)
def test_area_under_the_curve(error: float, limit: float, area: float) -> None:
    assert area_under_curve(error, limit) == pytest.approx(area)


def test_the_mean_area_is_the_area_of_the_set() -> None:
    errors, limit = np.array([0.2, 1.1, 2.4, 8.0]), 3.0
    grid = np.linspace(0, limit, 60001)
    share = (errors[:, None] <= grid).mean(axis=0)
    expected = float(np.trapezoid(share, grid)) / limit
    got = np.mean([area_under_curve(float(error), limit) for error in errors])
    assert got == pytest.approx(expected, abs=1e-4)
