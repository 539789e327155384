"""Simple solids in local frames: boxes, roofs, cylinders."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aerocues.simulation.mesh import MeshBuilder, Points

_BOX_FACES = np.array(
    [
        [4, 5, 6],
        [4, 6, 7],
        [0, 1, 5],
        [0, 5, 4],
        [1, 2, 6],
        [1, 6, 5],
        [2, 3, 7],
        [2, 7, 6],
        [3, 0, 4],
        [3, 4, 7],
    ]
)


@dataclass(frozen=True)
class Frame:
    """A local frame: x forward, y to the right, z up.

    Parameters
    ----------
    north, east, height : float
        Origin in metres.
    heading : float
        Direction of x in radians clockwise from north.
    """

    north: float
    east: float
    height: float
    heading: float

    def place(self, points: Points) -> Points:
        """World positions (north, east, height) of (N, 3) local points."""
        cos, sin = math.cos(self.heading), math.sin(self.heading)
        return np.column_stack(
            [
                self.north + points[:, 0] * cos - points[:, 1] * sin,
                self.east + points[:, 0] * sin + points[:, 1] * cos,
                self.height + points[:, 2],
            ]
        )

    def outline(self, points: list[tuple[float, float]]) -> Points:
        """World positions (north, east) of local positions."""
        flat = np.column_stack([np.array(points, np.float64), np.zeros(len(points))])
        return self.place(flat)[:, :2]

    def rectangle(self, low: tuple[float, float], high: tuple[float, float]) -> Points:
        """The four corners of a rectangle on the ground: world north, east."""
        return self.outline([low, (high[0], low[1]), high, (low[0], high[1])])

    def at(self, x: float, y: float, z: float = 0.0, turn: float = 0.0) -> Frame:
        """A frame at a local point, rotated by `turn` radians."""
        north, east, height = self.place(np.array([[x, y, z]]))[0]
        return Frame(float(north), float(east), float(height), self.heading + turn)


def add_box(
    builder: MeshBuilder,
    frame: Frame,
    low: tuple[float, float, float],
    high: tuple[float, float, float],
    surface: int,
    taper: float = 0.0,
) -> None:
    """Add a box without bottom; each side of its top is `taper` metres shorter."""
    corners = [
        (x + inward * tx, y + inward * ty, z)
        for z, inward in ((low[2], 0.0), (high[2], taper))
        for x, y, tx, ty in (
            (low[0], low[1], 1, 1),
            (high[0], low[1], -1, 1),
            (high[0], high[1], -1, -1),
            (low[0], high[1], 1, -1),
        )
    ]
    builder.add(frame.place(np.array(corners)), _BOX_FACES, surface)


def add_roof(
    builder: MeshBuilder,
    frame: Frame,
    half: tuple[float, float],
    eaves: float,
    rise: float,
    hip: float,
    surfaces: tuple[int, int, int],
) -> None:
    """Add a gable (hip 0) or hip roof whose ridge runs along y.

    Parameters
    ----------
    builder : MeshBuilder
    frame : Frame
    half : tuple of float
        Half of the roof's extent along x and y, overhang included.
    eaves, rise : float
        Height of the eaves, and of the ridge above them.
    hip : float
        Distance from the ends of the roof to the ends of the ridge.
    surfaces : tuple of int
        Surfaces of slopes, gables and fascia.
    """
    a, b = half
    corners = [(-a, -b), (a, -b), (a, b), (-a, b)]
    ridge = [(0.0, -b + hip, eaves + rise), (0.0, b - hip, eaves + rise)]
    points = np.array([(x, y, eaves) for x, y in corners] + ridge)
    slopes = np.array([[1, 2, 5], [1, 5, 4], [3, 0, 4], [3, 4, 5]])
    ends = np.array([[0, 1, 4], [2, 3, 5]])
    placed = frame.place(points)
    builder.add(placed, slopes, surfaces[0])
    builder.add(placed, ends, surfaces[0] if hip > 0 else surfaces[1])
    below = frame.place(np.array([(x, y, eaves - 0.2) for x, y in corners]))
    for i in range(4):
        j = (i + 1) % 4
        builder.quad(np.stack([placed[i], placed[j], below[j], below[i]]), surfaces[2])
    # The cap of the ridge.
    cap = frame.at(0.0, 0.0)
    add_box(
        builder,
        cap,
        (-0.16, -b + hip, eaves + rise - 0.1),
        (0.16, b - hip, eaves + rise + 0.06),
        surfaces[0],
    )


def add_pole(
    builder: MeshBuilder,
    frame: Frame,
    radii: tuple[float, float],
    height: float,
    surface: int,
    sides: int = 6,
    sink: float = 0.4,
) -> None:
    """Add an upright cone frustum from `sink` metres below the origin of the frame."""
    around = np.arange(sides) * 2 * math.pi / sides
    ring = np.column_stack([np.cos(around), np.sin(around)])
    points = np.concatenate(
        [
            np.column_stack([ring * radii[0], np.full(sides, -sink)]),
            np.column_stack([ring * radii[1], np.full(sides, height)]),
            [[0.0, 0.0, height]],
        ]
    )
    i = np.arange(sides)
    j = (i + 1) % sides
    faces = np.concatenate(
        [
            np.column_stack([i, j, sides + j]),
            np.column_stack([i, sides + j, sides + i]),
            np.column_stack([sides + i, sides + j, np.full(sides, 2 * sides)]),
        ]
    )
    builder.add(frame.place(points), faces, surface)


def sphere(rings: int = 4, sides: int = 6) -> tuple[Points, NDArray[np.int64]]:
    """Points (N, 3) and triangles (M, 3) of a unit sphere."""
    points = [(0.0, 0.0, 1.0)]
    for ring in range(1, rings):
        polar = math.pi * ring / rings
        for side in range(sides):
            around = 2 * math.pi * (side + 0.5 * (ring % 2)) / sides
            level = math.sin(polar)
            points.append((level * math.cos(around), level * math.sin(around), math.cos(polar)))
    points.append((0.0, 0.0, -1.0))
    faces = [(0, 1 + s, 1 + (s + 1) % sides) for s in range(sides)]
    for ring in range(rings - 2):
        a, b = 1 + ring * sides, 1 + (ring + 1) * sides
        for s in range(sides):
            t = (s + 1) % sides
            faces += [(a + s, b + s, a + t), (a + t, b + s, b + t)]
    last = len(points) - 1
    faces += [(last, last - sides + (s + 1) % sides, last - sides + s) for s in range(sides)]
    return np.array(points), np.array(faces)
