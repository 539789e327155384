"""One lot of a suburb: a house and a garden with its objects."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from aerocues.simulation.cars import add_car
from aerocues.simulation.gardens import (
    add_boulder,
    add_fence,
    add_furniture,
    add_pool,
    add_shed,
    along_ground,
)
from aerocues.simulation.ground import Cover
from aerocues.simulation.house_styles import varied
from aerocues.simulation.houses import add_house
from aerocues.simulation.mesh import Points
from aerocues.simulation.shapes import Frame
from aerocues.simulation.site import Site
from aerocues.simulation.streets import CARRIAGEWAY, RESERVE
from aerocues.simulation.trees import BY_NAME, KINDS, add_hedge

_TO_STREET = CARRIAGEWAY + 0.3 - RESERVE
"""Position of the kerb, from the front of a lot."""


@dataclass(frozen=True)
class Lot:
    """A rectangle of the grid; x goes from the street into the lot, y to the right.

    Parameters
    ----------
    site : Site
    front : float
        Position of the front, east on the grid.
    middle : float
        Position of the centre of the front, north on the grid.
    side : float
        1 if the lot is east of its street, -1 if west.
    width, depth : float
        Metres.
    """

    site: Site
    front: float
    middle: float
    side: float
    width: float
    depth: float

    def line(self, *points: tuple[float, float]) -> Points:
        """World points (north, east) of local points."""
        local = np.array(points, np.float64)
        grid = np.column_stack(
            [self.middle - self.side * local[:, 1], self.front + self.side * local[:, 0]]
        )
        return self.site.bend.place(grid)

    def rectangle(self, low: tuple[float, float], high: tuple[float, float]) -> Points:
        """World outline of a local rectangle."""
        return self.line(low, (high[0], low[1]), high, (low[0], high[1]))

    def frame(self, x: float, y: float, turn: float = 0.0) -> Frame:
        """A frame on the ground that faces into the lot."""
        u, v = self.middle - self.side * y, self.front + self.side * x
        return self.site.frame(u, v, self.side * math.pi / 2, turn)


def furnish_lot(lot: Lot) -> None:
    """Add house, driveway, path, terrace, fences and garden."""
    site, rng = lot.site, lot.site.rng
    angle = lot.frame(0.0, 0.0).heading + rng.choice([0.0, math.pi / 2])
    green = rng.beta(1.6, 1.4)
    site.painter.plot(angle, 0.12 + 0.75 * green, tuple(rng.uniform(0.88, 1.12, 3)))
    edge = lot.width / 2
    site.painter.polygon(lot.rectangle((0.0, -edge), (lot.depth, edge)), Cover.LAWN)
    _wear(lot, angle, green)
    garage = float(rng.choice([0.0, 3.4, 5.8], p=[0.3, 0.4, 0.3]))
    half = (rng.uniform(4.0, 5.4), min(rng.uniform(4.6, 7.2), (lot.width - garage - 3.0) / 2))
    setback = rng.uniform(5.5, 9.0)
    y = -garage / 2 + rng.uniform(-0.4, 0.4)
    house = lot.frame(setback + half[0], y)
    _pave(lot, (setback, y), half, garage)
    add_house(site.builder, rng, house, half, garage)
    back = setback + 2 * half[0]
    _enclose(lot, setback + half[0])
    _plant(lot, setback, back)
    _live(lot, back, y)


def _wear(lot: Lot, angle: float, green: float) -> None:
    """Paint parts of the lawn that are drier, greener or worn."""
    site, rng = lot.site, lot.site.rng
    for _ in range(int(rng.integers(2, 6))):
        dryness = np.clip(0.12 + 0.75 * green + rng.normal(0, 0.22), 0.0, 1.0)
        site.painter.plot(angle, float(dryness), tuple(rng.uniform(0.9, 1.1, 3)))
        reach = rng.uniform(0.15, 0.85) * lot.depth, rng.uniform(-0.32, 0.32) * lot.width
        centre = lot.line(reach)[0]
        radii = (rng.uniform(1.0, 4.5), rng.uniform(0.8, 3.0))
        site.painter.disc((centre[0], centre[1]), radii, rng.uniform(0, 3), Cover.LAWN, 0.16)


def _pave(lot: Lot, at: tuple[float, float], half: tuple[float, float], garage: float) -> None:
    site, rng = lot.site, lot.site.rng
    paint = site.painter
    angle = lot.frame(0.0, 0.0).heading
    paint.plot(angle, 0.5, tuple(rng.uniform(0.85, 1.12) * rng.uniform(0.95, 1.05, 3)))
    (setback, y), (a, b) = at, half
    beds = Cover.SOIL if rng.random() < 0.6 else Cover.GRAVEL
    paint.polygon(
        lot.rectangle((setback - 1.3, y - b - 0.9), (setback + 2 * a + 0.8, y + b + 0.9)), beds
    )
    floor = lot.rectangle((setback, y - b), (setback + 2 * a, y + b))
    paint.polygon(floor, Cover.GRAVEL)
    width = garage if garage > 0 else 2.9
    right = y + b + 0.2
    # A driveway without a garage ends next to the house.
    end = setback + (0.4 if garage > 0 else a)
    kind = (Cover.DRIVEWAY, Cover.PAVERS, Cover.YARD, Cover.GRAVEL)[
        int(rng.choice(4, p=[0.4, 0.25, 0.2, 0.15]))
    ]
    paint.polygon(lot.rectangle((_TO_STREET, right), (end, right + width - 0.4)), kind)
    if garage > 0:
        paint.polygon(lot.rectangle((end, right), (end + 7.0, right + width)), Cover.GRAVEL)
    door = y - 0.3 * b
    paint.polygon(
        lot.rectangle((_TO_STREET + 3.0, door - 0.6), (setback, door + 0.6)), Cover.PAVERS
    )
    back, reach = setback + 2 * a, rng.uniform(2.2, 4.5)
    side = rng.uniform(-0.9, 0.1) * b + y
    terrace = Cover.PAVERS if rng.random() < 0.6 else Cover.DRIVEWAY
    paint.polygon(
        lot.rectangle((back, side), (back + reach, side + rng.uniform(3.5, 6.0))), terrace
    )
    if rng.random() < 0.62:
        place = lot.frame(
            rng.uniform(-3.0, setback - 3.2),
            right + width / 2 - 0.2,
            0.0 if rng.random() < 0.6 else math.pi,
        )
        add_car(site.builder, rng, place)


def _enclose(lot: Lot, front: float) -> None:
    """Add a fence or hedge on the right and, for one of two neighbours, at the back."""
    site, rng, edge = lot.site, lot.site.rng, lot.width / 2
    line = lot.line((front, edge), (lot.depth, edge))
    if lot.side > 0:
        line = lot.line((front, edge), (lot.depth, edge), (lot.depth, -edge))
    draw = rng.random()
    if draw < 0.62:
        add_fence(site.builder, rng, site.terrain, line)
    elif draw < 0.85:
        points = along_ground(site.terrain, line, 3.0)
        colour = varied(rng, (0.075, 0.105, 0.038), 0.2)
        add_hedge(
            site.builder,
            rng,
            points,
            rng.uniform(0.7, 1.1),
            rng.uniform(1.1, 1.9),
            colour,
            site.detail(lot.frame(0.0, 0.0)),
        )
    if rng.random() < 0.22:
        door = rng.uniform(-0.2, 0.1) * lot.width
        points = along_ground(site.terrain, lot.line((0.6, -edge), (0.6, door - 2.0)), 3.0)
        add_hedge(
            site.builder,
            rng,
            points,
            0.7,
            rng.uniform(0.7, 1.1),
            varied(rng, (0.085, 0.115, 0.042), 0.2),
            site.detail(lot.frame(0.0, 0.0)),
        )


def _plant(lot: Lot, setback: float, back: float) -> None:
    site, rng, edge = lot.site, lot.site.rng, lot.width / 2
    for _ in range(int(rng.integers(7, 15))):
        deep = rng.random() < 0.75
        x = rng.uniform(back + 2.5, lot.depth - 1.6) if deep else rng.uniform(1.0, setback - 1.0)
        y = rng.choice([-1.0, 1.0]) * edge * (1 - 0.75 * rng.random() ** 1.6)
        site.plant(lot.frame(x, y * 0.9), scale=1.0 if deep else 0.75)
    for _ in range(int(rng.integers(8, 20))):  # bushes along the borders
        along = rng.uniform(1.0, lot.depth - 1.0)
        site.plant(
            lot.frame(along, rng.choice([-1.0, 1.0]) * (edge - rng.uniform(0.7, 1.4))),
            BY_NAME["bush"],
            rng.uniform(0.5, 1.1),
        )
    for _ in range(int(rng.integers(2, 7))):  # and in the bed in front of the house
        spot = lot.frame(setback - 0.7, rng.uniform(-0.42, 0.3) * lot.width)
        site.plant(spot, BY_NAME["bush"], rng.uniform(0.35, 0.6))


def _live(lot: Lot, back: float, y: float) -> None:
    site, rng, builder = lot.site, lot.site.rng, lot.site.builder
    edge, room = lot.width / 2, lot.depth - back
    if rng.random() < 0.2 and room > 11:
        add_pool(builder, rng, site.painter, lot.frame(back + rng.uniform(5.5, room - 4.5), y))
    if rng.random() < 0.5:
        corner = rng.choice([-1.0, 1.0]) * (edge - 2.6)
        add_shed(builder, rng, lot.frame(lot.depth - 2.6, corner, rng.choice([0, math.pi / 2])))
    for what, chance in (("table", 0.6), ("parasol", 0.3), ("trampoline", 0.16), ("lounger", 0.3)):
        if rng.random() < chance:
            deep = back + (1.6 if what != "trampoline" else 7.0)
            spot = lot.frame(deep, y + rng.uniform(-3.5, 3.0), rng.uniform(0, 3))
            add_furniture(builder, rng, spot, what)
    if rng.random() < 0.25:
        for number in range(int(rng.integers(2, 5))):
            spot = lot.frame(lot.depth - 3.0 - 1.9 * number, -edge * 0.55, math.pi / 2)
            add_furniture(builder, rng, spot, "box")
    for number in range(int(rng.integers(0, 4))):
        add_furniture(builder, rng, lot.frame(3.0, -edge + 1.2 + 0.8 * number), "bin")
    for _ in range(int(rng.integers(0, 4))):
        spot = lot.frame(rng.uniform(1.5, lot.depth - 1.5), rng.uniform(-0.45, 0.45) * lot.width)
        if site.painter.cover_at(spot.north, spot.east) == Cover.LAWN:
            add_boulder(builder, rng, spot)
    builder.finish_object()


def grow_meadow(lot: Lot) -> None:
    """An unbuilt lot: long grass, a worn path, trees and bushes."""
    site, rng, edge = lot.site, lot.site.rng, lot.width / 2
    site.painter.plot(0.0, rng.uniform(0.3, 0.8), tuple(rng.uniform(0.9, 1.1, 3)))
    site.painter.polygon(lot.rectangle((0.0, -edge), (lot.depth, edge)), Cover.MEADOW)
    bends = [(x, rng.uniform(-0.3, 0.3) * lot.width) for x in np.linspace(0, lot.depth, 6)]
    site.painter.band(lot.line(*bends), rng.uniform(0.6, 1.0), Cover.GRAVEL)
    for _ in range(int(lot.width * lot.depth / 45)):
        kind = KINDS[int(rng.integers(len(KINDS)))]
        spot = lot.frame(rng.uniform(1.0, lot.depth - 1.0), rng.uniform(-0.48, 0.48) * lot.width)
        site.plant(spot, kind, rng.uniform(0.6, 1.1))
