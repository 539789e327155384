"""Streets on a slightly bent grid: carriageways, kerbs, verges, pavements, markings."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aerocues.simulation.ground import Cover, Painter
from aerocues.simulation.mesh import Points

CARRIAGEWAY, VERGE_END, RESERVE = 3.6, 5.4, 7.0
"""Half widths in metres: the carriageway, up to the pavement, up to the gardens."""


@dataclass(frozen=True)
class Bend:
    """Bends the plane, so that straight streets of the grid become gentle curves.

    Parameters
    ----------
    phases : (4,) float64
        Radians.
    amount : float
        Metres.
    """

    phases: NDArray[np.float64]
    amount: float = 7.0

    def place(self, points: Points) -> Points:
        """World north, east of (N, 2) positions on the grid."""
        u, v = points[:, 0], points[:, 1]
        a, b, c, d = self.phases
        north = u + self.amount * np.sin(v / 105 + a) + 0.35 * self.amount * np.sin(v / 47 + b)
        east = v + self.amount * np.sin(u / 118 + c) + 0.3 * self.amount * np.sin(u / 53 + d)
        return np.column_stack([north, east])

    def heading(self, u: float, v: float, direction: float) -> float:
        """Direction in the world, radians from north, of a direction on the grid."""
        step = np.array([[math.cos(direction), math.sin(direction)]])
        here = np.array([[u, v]])
        moved = (self.place(here + 0.5 * step) - self.place(here - 0.5 * step))[0]
        return math.atan2(moved[1], moved[0])


@dataclass(frozen=True)
class Grid:
    """Northbound streets at `columns` (positions east), eastbound ones at `rows` (north)."""

    rows: tuple[float, ...]
    columns: tuple[float, ...]
    half: float

    def line(
        self,
        bend: Bend,
        along_north: bool,
        at: float,
        offset: float = 0.0,
        span: tuple[float, float] | None = None,
    ) -> Points:
        """World points along a street at an offset; `span` limits its length."""
        start, end = span or (-self.half, self.half)
        along = np.linspace(start, end, max(int((end - start) / 3), 2))
        across = np.full_like(along, at + offset)
        return bend.place(np.column_stack([along, across] if along_north else [across, along]))


def paint_streets(painter: Painter, grid: Grid, bend: Bend, rng: np.random.Generator) -> None:
    """Paint all streets, layer by layer, so that junctions are correct."""
    streets = [(True, at) for at in grid.columns] + [(False, at) for at in grid.rows]
    angles = {way: bend.heading(0.0, 0.0, 0.0 if way else math.pi / 2) for way in (True, False)}
    for cover, half in (
        (Cover.PAVEMENT, RESERVE),
        (Cover.LAWN, VERGE_END),
        (Cover.KERB, CARRIAGEWAY + 0.22),
        (Cover.ASPHALT, CARRIAGEWAY),
    ):
        for way, at in streets:
            painter.plot(angles[way], rng.uniform(0.35, 0.75), (1.0, 1.0, 1.0))
            painter.band(grid.line(bend, way, at), 2 * half, cover)
    painter.plot(0.0, 0.5, (1.0, 1.0, 1.0))
    _paint_repairs(painter, grid, bend, rng, streets)
    _paint_markings(painter, grid, bend, streets)


def _paint_repairs(
    painter: Painter,
    grid: Grid,
    bend: Bend,
    rng: np.random.Generator,
    streets: list[tuple[bool, float]],
) -> None:
    for way, at in streets:
        for start in np.arange(-grid.half, grid.half - 30, 24.0):
            offset, length = rng.uniform(-2.4, 2.4), rng.uniform(1.0, 14.0)
            if rng.random() < 0.6:
                begin = start + rng.uniform(0, 15)
                line = grid.line(bend, way, at, offset, (begin, begin + length))
                painter.band(line, rng.uniform(0.6, 1.9), Cover.PATCH)
            lid = grid.line(bend, way, at, rng.uniform(-1.5, 1.5), (start, start + 6))[1]
            painter.disc((lid[0], lid[1]), (0.36, 0.36), 0.0, Cover.COVERLID)


def _paint_markings(
    painter: Painter, grid: Grid, bend: Bend, streets: list[tuple[bool, float]]
) -> None:
    for way, at in streets:
        crossings = np.array(grid.rows if way else grid.columns)
        for start in np.arange(-grid.half, grid.half, 6.0):
            if np.abs(crossings - start - 1.5).min(initial=np.inf) > CARRIAGEWAY + 8.0:
                painter.band(grid.line(bend, way, at, 0.0, (start, start + 3)), 0.16, Cover.MARKING)
        for crossing in crossings:
            for side in (-1.0, 1.0):
                middle = crossing + side * (VERGE_END + 1.0)
                stop = crossing + side * (VERGE_END + 3.4)
                line = grid.line(bend, way, at, -side * 1.75, (stop - 0.2, stop + 0.2))
                painter.band(line, 3.2, Cover.MARKING)
                if (round(crossing) + round(at)) % 3:
                    continue
                for offset in np.arange(-3.1, 3.2, 1.0):
                    line = grid.line(bend, way, at, offset, (middle - 1.2, middle + 1.2))
                    painter.band(line, 0.5, Cover.MARKING)
