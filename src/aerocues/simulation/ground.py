"""The ground: a plan of covers in cells, painted polygon by polygon, and the terrain."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from aerocues.simulation.mesh import MeshBuilder, Points
from aerocues.simulation.surfaces import Material

CELL = 0.125
"""Side of a cell of the plan in metres: smaller cells have finer edges, and memory grows with the
inverse square."""

# Polygons are drawn with 1/16 of a cell: below a centimetre.
_FRACTION_BITS = 4
# Extent of the ground in metres: far enough for a horizon in oblique images.
_FAR = 4000.0


class Cover(IntEnum):
    """Cover of the ground."""

    MEADOW = 0
    LAWN = 1
    ASPHALT = 2
    PAVEMENT = 3
    KERB = 4
    MARKING = 5
    DRIVEWAY = 6
    PAVERS = 7
    SOIL = 8
    POOL = 9
    POND = 10
    GRAVEL = 11
    COURT = 12
    CROP = 13
    STUBBLE = 14
    PATCH = 15
    COVERLID = 16
    YARD = 17


class Plan(NamedTuple):
    """Cells of the ground.

    Parameters
    ----------
    cover : (N, N) uint8
        A `Cover`; rows go north, columns east.
    plot : (N, N) uint16
        Row of `plots`.
    plots : (P, 5) float32
        Direction (radians from north) of mowing, rows and joints; dryness from 0 to 1; tint:
        factors of red, green and blue.
    half : float
        Extent of the plan from the origin to each side, in metres.
    """

    cover: NDArray[np.uint8]
    plot: NDArray[np.uint16]
    plots: NDArray[np.float32]
    half: float


class Painter:
    """Paints a `Plan`; positions are (N, 2) north and east in metres."""

    def __init__(self, half: float) -> None:
        size = round(2 * half / CELL)
        self._half = half
        self._cover = np.zeros((size, size), np.uint8)
        self._plot = np.zeros((size, size), np.uint16)
        self._plots: list[tuple[float, ...]] = [(0.0, 0.55, 1.0, 1.0, 1.0)]
        self._current = 0

    def plot(self, angle: float, dryness: float, tint: tuple[float, float, float]) -> None:
        """Begin a plot: later polygons get its direction, dryness and tint."""
        self._plots.append((angle, dryness, *tint))
        self._current = len(self._plots) - 1

    def polygon(self, corners: Points, cover: Cover) -> None:
        """Fill a polygon."""
        import cv2

        points = self._pixels(corners)
        for plane, value in ((self._cover, int(cover)), (self._plot, self._current)):
            cv2.fillPoly(plane, [points], value, shift=_FRACTION_BITS)

    def band(self, line: Points, width: float, cover: Cover) -> None:
        """Fill a band of the given width in metres along a line of points."""
        along = np.gradient(line, axis=0)
        along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-9)
        across = np.column_stack([-along[:, 1], along[:, 0]]) * width / 2
        self.polygon(np.concatenate([line + across, (line - across)[::-1]]), cover)

    def disc(
        self,
        centre: tuple[float, float],
        radii: tuple[float, float],
        turn: float,
        cover: Cover,
        waves: float = 0.0,
    ) -> None:
        """Fill an ellipse, rotated by `turn` radians; `waves` makes its edge uneven."""
        around = np.linspace(0, 2 * math.pi, 64, endpoint=False)
        reach = 1 + waves * (np.sin(3 * around + centre[0]) + 0.6 * np.sin(5 * around + centre[1]))
        u, v = radii[0] * reach * np.cos(around), radii[1] * reach * np.sin(around)
        cos, sin = math.cos(turn), math.sin(turn)
        outline = np.column_stack([centre[0] + u * cos - v * sin, centre[1] + u * sin + v * cos])
        self.polygon(outline, cover)

    def cover_at(self, north: float, east: float) -> Cover:
        """The cover at a point of the plan."""
        row, column = int((north + self._half) / CELL), int((east + self._half) / CELL)
        return Cover(int(self._cover[row, column]))

    def finish(self) -> Plan:
        """The plan as painted so far."""
        return Plan(self._cover, self._plot, np.array(self._plots, np.float32), self._half)

    def _pixels(self, corners: Points) -> NDArray[np.int32]:
        # OpenCV takes column and row; the centre of cell i is at (i + 0.5) CELL - half.
        pixels = (corners[:, ::-1] + self._half) / CELL - 0.5
        return np.asarray(np.rint(pixels * 2**_FRACTION_BITS), np.int32)


@dataclass(frozen=True)
class Terrain:
    """Gentle relief: a sum of long waves.

    Parameters
    ----------
    waves : (K, 4) float64
        Angular frequencies north and east (radians a metre), phase, amplitude in metres.
    """

    waves: NDArray[np.float64]

    @classmethod
    def from_seed(cls, rng: np.random.Generator, amplitude: float) -> Terrain:
        """Six waves of 140 to 420 m; `amplitude` is approximately the maximum height in metres."""
        angle, length = rng.uniform(0, 2 * math.pi, 6), rng.uniform(140, 420, 6)
        frequency = 2 * math.pi / length
        share = amplitude * length / length.sum()
        north, east = frequency * np.cos(angle), frequency * np.sin(angle)
        return cls(np.column_stack([north, east, rng.uniform(0, 2 * math.pi, 6), share]))

    def height(self, points: Points) -> NDArray[np.float64]:
        """Height in metres at (N, 2) positions north, east; 0 at the origin."""
        return self._sum(points) - self._sum(np.zeros((1, 2)))

    def _sum(self, points: Points) -> NDArray[np.float64]:
        phases = points @ self.waves[:, :2].T + self.waves[:, 2]
        heights: NDArray[np.float64] = np.sin(phases) @ self.waves[:, 3]
        return heights

    def drape(self, points: Points, above: float = 0.0) -> Points:
        """(N, 3) positions on the ground, or `above` metres over it."""
        return np.column_stack([points[:, :2], self.height(points) + above])


def add_terrain(builder: MeshBuilder, terrain: Terrain, half: float) -> None:
    """Add the ground: 2 m cells inside the plan, increasingly wide cells to the horizon."""
    ground = builder.surface(Material.GROUND, (0.5, 0.5, 0.5))
    edges = np.linspace(-half, half, max(int(half // 16), 2))
    for south, north in itertools.pairwise(edges):
        for west, east in itertools.pairwise(edges):
            _add_grid(builder, terrain, (south, north, west, east), 16, ground, 0.0)
    inner = half - 4.0
    while inner < _FAR:
        outer = 2 * inner
        for south, north, west, east in (
            (inner, outer, -outer, outer),
            (-outer, -inner, -outer, outer),
            (-inner, inner, -outer, -inner),
            (-inner, inner, inner, outer),
        ):
            _add_grid(builder, terrain, (south, north, west, east), 48, ground, -0.15)
        # Rings overlap, each lower than the inner one, so that there are no gaps.
        inner = outer - 4.0


def _add_grid(
    builder: MeshBuilder,
    terrain: Terrain,
    bounds: tuple[float, float, float, float],
    cells: int,
    surface: int,
    above: float,
) -> None:
    south, north, west, east = bounds
    x, y = np.meshgrid(
        np.linspace(south, north, cells + 1), np.linspace(west, east, cells + 1), indexing="ij"
    )
    corner = np.arange((cells + 1) ** 2).reshape(cells + 1, cells + 1)
    a, b, c, d = corner[:-1, :-1], corner[:-1, 1:], corner[1:, 1:], corner[1:, :-1]
    halves = [np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)]
    points = np.column_stack([x.ravel(), y.ravel()])
    builder.add(terrain.drape(points, above), np.concatenate(halves), surface)
    builder.finish_object()
