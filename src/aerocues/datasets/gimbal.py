"""What a drone of DJI wrote into a photo of its height and of the direction of its camera."""

from __future__ import annotations

from dataclasses import dataclass

from aerocues.datasets.yaw import written_number

FIELDS = ("RelativeAltitude", "GimbalPitchDegree", "GimbalYawDegree", "GimbalRollDegree")
LOWEST = 1.0


@dataclass(frozen=True)
class GimbalView:
    """Height and direction of a camera.

    Parameters
    ----------
    height : float
        Metres above the place of the start.
    pitch, yaw, roll : float
        Degrees, as `flight_angles.camera_from_ned` takes them.
    """

    height: float
    pitch: float
    yaw: float
    roll: float


def gimbal_view(xmp: bytes | str | None) -> GimbalView | None:
    """From the XMP packet of a photo; None where it lacks a value, or is not above the ground."""
    values = [value for name in FIELDS if (value := written_number(xmp, name)) is not None]
    if len(values) < len(FIELDS) or values[0] < LOWEST:
        return None
    return GimbalView(*values)
