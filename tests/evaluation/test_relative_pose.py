from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from aerocues.datasets.dataset import PinholeCamera, TrueView
from aerocues.evaluation.relative_pose import RelativePose, estimate_pose, pose_error, true_pose
from aerocues.pipeline.clock import Clock
from aerocues.pipeline.protocol import MeasurementProtocol, Verification
from aerocues.pipeline.verification import Verifier, magsac_parameters

FIRST = PinholeCamera(640, 480, 500.0, 500.0, 319.5, 239.5)
SECOND = PinholeCamera(800, 600, 700.0, 710.0, 390.0, 310.0)
PARAMETERS = magsac_parameters(Verification())


def turned(degrees: float, axis: str = "y") -> NDArray[np.float64]:
    return np.asarray(Rotation.from_euler(axis, degrees, degrees=True).as_matrix(), np.float64)


def view(camera: PinholeCamera, rotation: NDArray[np.float64], *centre: float) -> TrueView:
    return TrueView(camera, rotation, np.array(centre, np.float64))


def seen(points: NDArray[np.float64], by: TrueView) -> NDArray[np.float32]:
    x, y, z = by.rotation @ (points - by.centre).T
    camera = by.camera
    columns = camera.focal_x * x / z + camera.centre_x
    rows = camera.focal_y * y / z + camera.centre_y
    return np.column_stack([columns, rows]).astype(np.float32)


def test_the_true_pose_is_that_of_camera_2_to_camera_1() -> None:
    quarter = turned(90, "z")
    pose = true_pose(view(FIRST, np.eye(3), 0, 0, 0), view(FIRST, quarter, 1, 0, 0))
    np.testing.assert_allclose(pose.rotation, quarter)
    # Camera 1 lies at -x of camera 2 in the world, which is -y in the axes of camera 2.
    np.testing.assert_allclose(pose.direction, quarter @ [-1, 0, 0])


@pytest.mark.parametrize("noise", [0.0, 0.4])
def test_the_pose_of_a_scene_in_depth_is_found(noise: float) -> None:
    generator = np.random.default_rng(4)
    points = generator.uniform((-4, -3, 6), (4, 3, 14), (400, 3))
    first = view(FIRST, np.eye(3), 0, 0, 0)
    second = view(SECOND, turned(8), 1.0, 0.2, 0.1)
    points_1, points_2 = seen(points, first), seen(points, second)
    points_1 += generator.normal(0, noise, points_1.shape).astype(np.float32)
    points_2[:100] = generator.uniform((0, 0), (800, 600), (100, 2))  # a quarter is wrong
    found = estimate_pose(points_1, points_2, (FIRST, SECOND), PARAMETERS)
    error = pose_error(found, true_pose(first, second))
    assert error < (0.05 if noise == 0 else 2.0)


def test_a_nearly_flat_scene_has_one_pose() -> None:
    # Ground 140 m below with houses and trees, and half a pixel of noise: with 3 px, estimates
    # end in the second pose that a plane has.
    generator = np.random.default_rng(1)
    points = generator.uniform((-120, -80, 130), (120, 80, 140), (1500, 3))
    points[:900, 2] = 140
    first = view(FIRST, np.eye(3), 0, 0, 0)
    second = view(FIRST, np.eye(3), 0, -40.0, 0)
    points_1, points_2 = seen(points, first), seen(points, second)
    points_2 += generator.normal(0, 0.5, points_2.shape).astype(np.float32)
    points_2[:300] = generator.uniform((0, 0), (640, 480), (300, 2))
    protocol = MeasurementProtocol()
    parameters, guided = Verifier(protocol, "epipolar", Clock()).pose_parameters("uniform")
    assert not guided
    found = estimate_pose(points_1, points_2, (FIRST, FIRST), parameters)
    assert pose_error(found, true_pose(first, second)) < 2


def test_too_few_points_have_no_pose() -> None:
    nothing = np.zeros((4, 2), np.float32)
    assert estimate_pose(nothing, nothing, (FIRST, FIRST), PARAMETERS) is None
    truth = RelativePose(np.eye(3), np.array([1.0, 0, 0]))
    assert pose_error(None, truth) == np.inf


def test_points_that_coincide_have_no_pose_or_a_wrong_one_but_do_not_raise() -> None:
    same = np.ones((40, 2), np.float32)
    found = estimate_pose(same, same, (FIRST, FIRST), PARAMETERS)
    assert pose_error(found, RelativePose(np.eye(3), np.array([1.0, 0, 0]))) >= 0


def test_the_error_is_the_larger_of_two_angles() -> None:
    truth = RelativePose(np.eye(3), np.array([2.0, 0, 0]))
    estimate = RelativePose(turned(3), turned(10, "z") @ [1.0, 0, 0])
    assert pose_error(estimate, truth) == pytest.approx(10)
    estimate = RelativePose(turned(30), np.array([1.0, 0, 0]))
    assert pose_error(estimate, truth) == pytest.approx(30)
    # The other way round is as wrong as can be.
    assert pose_error(RelativePose(np.eye(3), np.array([-1.0, 0, 0])), truth) == pytest.approx(180)


def test_cameras_at_one_place_are_told_by_their_rotation() -> None:
    truth = RelativePose(np.eye(3), np.zeros(3))
    estimate = RelativePose(turned(7), np.array([0.0, 1, 0]))
    assert pose_error(estimate, truth) == pytest.approx(7)
