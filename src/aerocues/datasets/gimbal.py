"""What a drone of DJI wrote into a photo of its height and of the direction of its camera."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

FIELDS = {
    "height": "RelativeAltitude",
    "pitch": "GimbalPitchDegree",
    "yaw": "GimbalYawDegree",
    "roll": "GimbalRollDegree",
}
# Attributes of the XMP packet, or elements of it.
_FIELD = re.compile(rb"drone-dji:(\w+)\s*(?:=\s*\"|>)\s*([+-]?\d+(?:\.\d+)?)\s*[\"<]")
_HEAD = 1 << 17
"""Bytes of a file in which the packet is looked for: metadata comes before the image."""
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


def gimbal_view(path: Path) -> GimbalView | None:
    """From the XMP packet of a photo; None where it lacks a value, or is not above the ground.

    Parameters
    ----------
    path : Path
        A file that can be read.
    """
    with path.open("rb") as file:
        head = file.read(_HEAD)
    found = {name.decode(): float(value) for name, value in _FIELD.findall(head)}
    if not found.keys() >= set(FIELDS.values()):
        return None
    view = GimbalView(**{name: found[field] for name, field in FIELDS.items()})
    return view if view.height >= LOWEST else None
