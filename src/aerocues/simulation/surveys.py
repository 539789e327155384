"""Survey flights as data: names and poses of all images."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from aerocues.errors import SimulationError
from aerocues.simulation.camera import Pose

# Distance of the nodes in metres, as in the thesis.
_STEP = 40.0


@dataclass(frozen=True)
class Shot:
    """One image of a survey; its name is the path without suffix in the folder of the flight."""

    name: str
    pose: Pose


@dataclass(frozen=True)
class Survey:
    """Images in the order of the flight."""

    name: str
    shots: tuple[Shot, ...]


@dataclass(frozen=True)
class Layer:
    """Nodes of a square grid at one height.

    Parameters
    ----------
    down : float
        Metres; negative above the origin.
    nodes : int
        Nodes along each side; the grid is centred at the origin.
    step : float
        Metres between nodes.
    """

    down: float
    nodes: int
    step: float = _STEP

    def serpentine(self) -> list[tuple[float, float, int]]:
        """North, east and line number of each node: north and back, line by line."""
        at = (np.arange(self.nodes) - (self.nodes - 1) / 2) * self.step
        return [
            (float(north), float(east), line)
            for line, east in enumerate(at)
            for north in (at if line % 2 == 0 else at[::-1])
        ]


_VIEWS = ((-60.0, 0.0), (-60.0, -90.0), (-90.0, 0.0), (-120.0, 0.0), (-120.0, -90.0))
_AIRSIMNH = (Layer(-60.0, 9), Layer(-100.0, 7), Layer(-140.0, 5))
_NATURAL = (Layer(-80.0, 7), Layer(-110.0, 5), Layer(-140.0, 3))


def _shot(folder: str, number: int, pose: Pose) -> Shot:
    place = f"z{pose.down:g}_y{pose.east:g}_x{pose.north:g}"
    return Shot(f"{folder}/{number:03d}_{place}", pose)


def airsimnh() -> Survey:
    """Three layers, five views at each node, a folder for each view: 775 images."""
    shots = [
        _shot(
            f"Layer{number}/pitch{pitch:g}_yaw{yaw:g}",
            index,
            Pose(north, east, layer.down, pitch, yaw),
        )
        for number, layer in enumerate(_AIRSIMNH, 1)
        for pitch, yaw in _VIEWS
        for index, (north, east, _) in enumerate(layer.serpentine())
    ]
    return Survey("airsimnh", tuple(shots))


def airsimnh_natural() -> Survey:
    """Three layers as drones fly, with the camera facing forward, north and back: 83 images."""
    shots = [
        _shot(f"Layer{number}", index, Pose(north, east, layer.down, -60.0, 180.0 * (line % 2)))
        for number, layer in enumerate(_NATURAL, 1)
        for index, (north, east, line) in enumerate(layer.serpentine())
    ]
    return Survey("airsimnh-natural", tuple(shots))


def mini() -> Survey:
    """Two short lines at 60 m: 6 images, for a quick try."""
    lines = ((-15.0, (-20.0, 0.0, 20.0)), (15.0, (20.0, 0.0, -20.0)))
    nodes = [(north, east) for east, norths in lines for north in norths]
    shots = [
        _shot("Layer1", i, Pose(north, east, -60.0, -90.0, 0.0))
        for i, (north, east) in enumerate(nodes)
    ]
    return Survey("mini", tuple(shots))


SURVEYS = {"airsimnh": airsimnh, "airsimnh-natural": airsimnh_natural, "mini": mini}


def survey_called(name: str) -> Survey:
    """The survey of this name in `SURVEYS`; SimulationError if there is none."""
    if name.lower() not in SURVEYS:
        raise SimulationError(f"there is no survey '{name}'; use {', '.join(SURVEYS)} or a file")
    return SURVEYS[name.lower()]()
