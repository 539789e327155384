"""Camera angles and world axes in the conventions of AirSim and gimbals."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

ENU_FROM_NED = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
"""From north, east, down to east, north, up; it is its own inverse."""

_BODY_TO_CAMERA = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
"""From body axes (x forward, y right, z down) to the camera's (x right, y down, z forward)."""


def camera_from_ned(pitch: float, yaw: float, roll: float) -> NDArray[np.float64]:
    """Rotation from north, east, down to the camera: C (Rz(yaw) Ry(pitch) Rx(roll))^T.

    Parameters
    ----------
    pitch, yaw, roll : float
        Degrees. Pitch 0 is horizontal, -90 straight down; yaw 0 is north, 90 is east.

    Returns
    -------
    (3, 3) float64
    """
    (cp, cy, cr), (sp, sy, sr) = (
        [function(math.radians(angle)) for angle in (pitch, yaw, roll)]
        for function in (math.cos, math.sin)
    )
    about_z = np.array([[cy, -sy, 0.0], [sy, cy, 0.0], [0.0, 0.0, 1.0]])
    about_y = np.array([[cp, 0.0, sp], [0.0, 1.0, 0.0], [-sp, 0.0, cp]])
    about_x = np.array([[1.0, 0.0, 0.0], [0.0, cr, -sr], [0.0, sr, cr]])
    rotation: NDArray[np.float64] = _BODY_TO_CAMERA @ (about_z @ about_y @ about_x).T
    return rotation
