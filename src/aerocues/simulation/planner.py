"""Plans surveys from missions: area, altitude or ground sampling distance, overlaps."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

from aerocues.datasets.dataset import PinholeCamera
from aerocues.errors import SimulationError
from aerocues.json_files import read_json
from aerocues.simulation.camera import Pose
from aerocues.simulation.surveys import SURVEYS, Shot, Survey, survey_called

PATTERNS = ("nadir", "oblique", "double", "orbit")


@dataclass(frozen=True)
class Mission:
    """A mission; its area is centred at the origin.

    Parameters
    ----------
    pattern : str
        ``nadir`` or ``oblique``: parallel lines, north and back; ``double``: also lines across;
        ``orbit``: a circle around the area, facing its centre.
    north, east : float
        Extent of the area in metres.
    altitude : float or None
        Metres above the origin.
    gsd : float or None
        Ground sampling distance at the nadir in centimetres per pixel, in place of the altitude.
    front, side : float
        Overlap of consecutive images and of neighbouring lines, at least 0 and below 1.
    pitch : float
        Pitch of the camera in ``oblique`` and ``orbit``, degrees.
    """

    pattern: str = "nadir"
    north: float = 120.0
    east: float = 120.0
    altitude: float | None = None
    gsd: float | None = None
    front: float = 0.8
    side: float = 0.7
    pitch: float = -60.0

    def __post_init__(self) -> None:
        if self.pattern not in PATTERNS:
            raise SimulationError(
                f"pattern must be one of {', '.join(PATTERNS)}, got {self.pattern!r}"
            )
        if (self.altitude is None) == (self.gsd is None):
            raise SimulationError("a mission needs either altitude or gsd")
        if not (0 <= self.front < 1 and 0 <= self.side < 1):
            raise SimulationError("front and side must be at least 0 and below 1")
        if min(self.north, self.east, self.altitude or 1.0, self.gsd or 1.0) <= 0:
            raise SimulationError("north, east, altitude and gsd must be above 0")

    def height(self, camera: PinholeCamera) -> float:
        """Metres above the origin."""
        if self.altitude is not None:
            return self.altitude
        return round((self.gsd or 0.0) / 100 * camera.focal_x, 6)


FIELDS = tuple(field.name for field in fields(Mission))
KNOWN = ", ".join(FIELDS)


def plan(mission: Mission, camera: PinholeCamera, name: str = "mission") -> Survey:
    """The images of a mission."""
    height = mission.height(camera)
    ahead = camera.height / camera.focal_y * height * (1 - mission.front)
    beside = camera.width / camera.focal_x * height * (1 - mission.side)
    if mission.pattern == "orbit":
        poses = list(_orbit(mission, height, ahead))
    else:
        pitch = mission.pitch if mission.pattern == "oblique" else -90.0
        poses = list(_lines(mission, height, (ahead, beside), pitch))
        if mission.pattern == "double":
            turned = Mission(north=mission.east, east=mission.north, altitude=height)
            poses += [
                Pose(-pose.east, pose.north, pose.down, pose.pitch, (pose.yaw + 90.0) % 360.0)
                for pose in _lines(turned, height, (ahead, beside), pitch)
            ]
    shots = tuple(Shot(f"{name}/{index:04d}", pose) for index, pose in enumerate(poses))
    return Survey(name, shots)


def _spread(extent: float, step: float) -> list[float]:
    """Positions at most `step` apart over the whole extent."""
    count = math.ceil(extent / step - 1e-9) + 1
    return [float(at) for at in np.linspace(-extent / 2, extent / 2, count)]


def _lines(
    mission: Mission, height: float, steps: tuple[float, float], pitch: float
) -> Iterator[Pose]:
    nodes = _spread(mission.north, steps[0])
    for line, east in enumerate(_spread(mission.east, steps[1])):
        for north in nodes if line % 2 == 0 else reversed(nodes):
            yield Pose(north, east, -height, pitch, 180.0 * (line % 2))


def _orbit(mission: Mission, height: float, ahead: float) -> Iterator[Pose]:
    radius = math.hypot(mission.north, mission.east) / 2
    count = max(math.ceil(2 * math.pi * radius / ahead), 8)
    for number in range(count):
        angle = 360.0 * number / count
        north, east = (radius * part(math.radians(angle)) for part in (math.cos, math.sin))
        yield Pose(north, east, -height, mission.pitch, (angle + 180.0) % 360.0)


def open_survey(
    survey: str | Path | Mapping[str, object] | Mission, camera: PinholeCamera
) -> Survey:
    """A survey by its name, or of a mission: its JSON file, or the fields of `Mission`.

    Raises
    ------
    SimulationError
        If it is none of them, or the terms of the mission make no sense.
    """
    if isinstance(survey, Mission):
        return plan(survey, camera)
    if isinstance(survey, Mapping):
        return plan(_mission(survey, "the mission"), camera)
    file = Path(survey)
    if str(survey).lower() in SURVEYS or not file.is_file():
        return survey_called(str(survey))
    terms = read_json(file, "the mission", SimulationError, f"give a JSON file with {KNOWN}")
    return plan(_mission(terms, str(file)), camera, file.stem)


def _mission(terms: Any, where: str) -> Mission:
    if not isinstance(terms, Mapping):
        raise SimulationError(f"{where} is not a mission: it must hold an object with {KNOWN}")
    unknown = [str(name) for name in terms if name not in FIELDS]
    if unknown:
        raise SimulationError(f"{where}: {', '.join(unknown)} is unknown; use {KNOWN}")
    try:
        return Mission(**terms)
    except (ValueError, TypeError) as error:
        raise SimulationError(f"{where} is not a mission ({error}); use {KNOWN}") from error
