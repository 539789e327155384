from __future__ import annotations

import numpy as np
import pytest

from aerocues.simulation.camera import Pose, enlarged, pinhole


def test_the_axis_meets_the_middle_of_the_picture() -> None:
    camera = pinhole(1000, 665, 90.0)
    assert (camera.focal_x, camera.focal_y) == pytest.approx((500.0, 500.0))
    # 500, 332.5 from the corner of the picture; pixel centres at integers are half a pixel less.
    assert (camera.centre_x, camera.centre_y) == (499.5, 332.0)


def test_samples_lie_evenly_in_each_pixel() -> None:
    camera = pinhole(10, 8, 60.0)
    fine = enlarged(camera, 2)
    slopes = (np.arange(20) - fine.centre_x) / fine.focal_x
    per_pixel = slopes.reshape(10, 2)
    middle = (np.arange(10) - camera.centre_x) / camera.focal_x
    assert per_pixel.mean(axis=1) == pytest.approx(middle)
    assert per_pixel[0, 1] - per_pixel[0, 0] == pytest.approx(0.5 / camera.focal_x)


@pytest.mark.parametrize(
    ("pitch", "yaw", "ahead", "right"),
    [
        (0.0, 0.0, (1, 0, 0), (0, 1, 0)),
        (0.0, 90.0, (0, 1, 0), (-1, 0, 0)),
        (-90.0, 0.0, (0, 0, 1), (0, 1, 0)),
        (-60.0, 180.0, (-0.5, 0, np.sqrt(0.75)), (0, -1, 0)),
        (-120.0, 0.0, (-0.5, 0, np.sqrt(0.75)), (0, 1, 0)),
    ],
)
def test_angles_are_those_of_airsim(
    pitch: float, yaw: float, ahead: tuple[float, ...], right: tuple[float, ...]
) -> None:
    rotation = Pose(0, 0, -50, pitch, yaw).rotation
    assert rotation[2] == pytest.approx(np.array(ahead), abs=1e-12)
    assert rotation[0] == pytest.approx(np.array(right), abs=1e-12)
    assert rotation @ rotation.T == pytest.approx(np.eye(3))
    assert np.linalg.det(rotation) == pytest.approx(1.0)
