"""Camera poses and projection, with AirSim's angles and OpenCV's pixels."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.dataset import PinholeCamera
from aerocues.datasets.flight_angles import camera_from_ned


@dataclass(frozen=True)
class Pose:
    """A camera in the world: north, east, down.

    Parameters
    ----------
    north, east, down : float
        Position in metres; ``down`` is negative above the origin, as in AirSim.
    pitch, yaw, roll : float
        Degrees. Pitch 0 is horizontal, -90 straight down; yaw 0 is north, 90 is east.
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
        """(3, 3) float64 from the world to the camera."""
        return camera_from_ned(self.pitch, self.yaw, self.roll)


def pinhole(width: int, height: int, fov: float) -> PinholeCamera:
    """A camera with a horizontal field of view of `fov` degrees and a centred principal point.

    The centre of the image is (width / 2, height / 2) from its upper left corner, and half a pixel
    less if the centre of the first pixel is (0, 0).
    """
    focal = width / 2 / math.tan(math.radians(fov) / 2)
    return PinholeCamera(width, height, focal, focal, width / 2 - 0.5, height / 2 - 0.5)


def enlarged(camera: PinholeCamera, factor: int) -> PinholeCamera:
    """The camera with `factor` x `factor` evenly spaced samples in each pixel."""
    return PinholeCamera(
        camera.width * factor,
        camera.height * factor,
        camera.focal_x * factor,
        camera.focal_y * factor,
        (camera.centre_x + 0.5) * factor - 0.5,
        (camera.centre_y + 0.5) * factor - 0.5,
    )
