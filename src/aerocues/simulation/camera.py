"""Where a camera is and looks, and how it projects: AirSim's angles, OpenCV's pixels."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.dataset import PinholeCamera

_BODY_TO_CAMERA = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
"""From body axes (x forward, y right, z down) to the camera's (x right, y down, z forward)."""


@dataclass(frozen=True)
class Pose:
    """A camera in the world: north, east, down.

    Parameters
    ----------
    north, east, down : float
        Position in metres; ``down`` is negative above the origin, as in AirSim.
    pitch, yaw, roll : float
        Degrees. Pitch 0 looks at the horizon, -90 at the ground; yaw 0 is north, 90 is east.
    """

    north: float
    east: float
    down: float
    pitch: float
    yaw: float
    roll: float = 0.0

    @property
    def centre(self) -> NDArray[np.float64]:
        """The position as (3,) float64."""
        return np.array([self.north, self.east, self.down])

    @property
    def rotation(self) -> NDArray[np.float64]:
        """(3, 3) float64 from the world to the camera: C (Rz(yaw) Ry(pitch) Rx(roll))^T."""
        return _BODY_TO_CAMERA @ body_rotation(self.pitch, self.yaw, self.roll).T


def body_rotation(pitch: float, yaw: float, roll: float) -> NDArray[np.float64]:
    """(3, 3) float64 from body axes to the world, Rz(yaw) Ry(pitch) Rx(roll); degrees."""
    (cp, cy, cr), (sp, sy, sr) = (
        [function(math.radians(angle)) for angle in (pitch, yaw, roll)]
        for function in (math.cos, math.sin)
    )
    about_z = np.array([[cy, -sy, 0.0], [sy, cy, 0.0], [0.0, 0.0, 1.0]])
    about_y = np.array([[cp, 0.0, sp], [0.0, 1.0, 0.0], [-sp, 0.0, cp]])
    about_x = np.array([[1.0, 0.0, 0.0], [0.0, cr, -sr], [0.0, sr, cr]])
    rotation: NDArray[np.float64] = about_z @ about_y @ about_x
    return rotation


def pinhole(width: int, height: int, fov: float) -> PinholeCamera:
    """A camera whose horizontal field of view is `fov` degrees and whose axis meets the middle.

    The middle of the picture is (width / 2, height / 2) from its upper left corner, which is half a
    pixel less where the centre of the first pixel is (0, 0).
    """
    focal = width / 2 / math.tan(math.radians(fov) / 2)
    return PinholeCamera(width, height, focal, focal, width / 2 - 0.5, height / 2 - 0.5)


def enlarged(camera: PinholeCamera, factor: int) -> PinholeCamera:
    """The camera with `factor` x `factor` samples in each pixel, evenly spread over it."""
    return PinholeCamera(
        camera.width * factor,
        camera.height * factor,
        camera.focal_x * factor,
        camera.focal_y * factor,
        (camera.centre_x + 0.5) * factor - 0.5,
        (camera.centre_y + 0.5) * factor - 0.5,
    )
