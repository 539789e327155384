"""The scene `industrial`: halls, flat roofs, yards, containers, car parks; large plain areas."""

from __future__ import annotations

import itertools
import math

import numpy as np

from aerocues.simulation.cars import add_car
from aerocues.simulation.gardens import add_fence
from aerocues.simulation.ground import Cover
from aerocues.simulation.scene import Scene
from aerocues.simulation.shapes import Frame
from aerocues.simulation.site import Site
from aerocues.simulation.streets import RESERVE, Grid
from aerocues.simulation.yards import add_containers, add_hall, add_tank, add_works

# Distances of the streets in metres, east-west and north-south: blocks for large buildings.
_ROW, _COLUMN = 150.0, 118.0


def build_industrial(seed: int, half: float) -> Scene:
    """Build the scene; it extends `half` metres from the origin to each side."""
    rows = tuple(float(at) for at in np.arange(-4 * _ROW + 40, half, _ROW) if abs(at) < half - 20)
    columns = tuple(
        float(at) for at in np.arange(-6 * _COLUMN + 50, half, _COLUMN) if abs(at) < half - 20
    )
    rng = np.random.default_rng([seed, 2])
    site = Site("industrial", rng, half, Grid(rows, columns, half), relief=2.5)
    site.paint_streets()
    edges_u, edges_v = (-half, *rows, half), (-half, *columns, half)
    for south, north in itertools.pairwise(edges_u):
        for west, east in itertools.pairwise(edges_v):
            low, high = (south + RESERVE, west + RESERVE), (north - RESERVE, east - RESERVE)
            if min(high[0] - low[0], high[1] - low[1]) > 20.0:
                _fill_block(site, low, high)
    site.line_streets(trees=True)
    return site.finish()


def _fill_block(site: Site, low: tuple[float, float], high: tuple[float, float]) -> None:
    """Two sites one behind the other, each in a fenced yard with a green edge."""
    middle = (low[0] + high[0]) / 2
    for start, end in ((low[0], middle), (middle, high[0])):
        centre = ((start + end) / 2, (low[1] + high[1]) / 2)
        size = ((end - start) / 2 - 3.0, (high[1] - low[1]) / 2 - 3.0)
        if min(size) > 14.0:
            _lay_yard(site, site.frame(*centre, 0.0), size)


def _lay_yard(site: Site, frame: Frame, half: tuple[float, float]) -> None:
    rng, paint = site.rng, site.painter
    tint = tuple(rng.uniform(0.85, 1.15, 1).repeat(3))
    paint.plot(frame.heading, rng.uniform(0.4, 0.9), (1.0, 1.0, 1.0))
    paint.polygon(
        frame.rectangle((-half[0] - 3, -half[1] - 3), (half[0] + 3, half[1] + 3)), Cover.LAWN
    )
    paint.plot(frame.heading, 0.5, (tint[0], tint[1], tint[2]))
    surface = (Cover.YARD, Cover.DRIVEWAY, Cover.GRAVEL)[int(rng.choice(3, p=[0.55, 0.3, 0.15]))]
    a, b = half
    paint.polygon(frame.rectangle((-a + 1, -b + 1), (a - 1, b - 1)), surface)
    for side in (-1.0, 1.0):  # a gate to each street
        paint.polygon(frame.rectangle((-4.0, side * b - 12), (4.0, side * b + 12)), Cover.YARD)
    outline = [(-a, -b), (a, -b), (a, b), (-a, b)]
    add_fence(site.builder, rng, site.terrain, frame.outline([*outline[1:3]]))
    _build(site, frame, half)
    _park(site, frame, half)
    for _ in range(40):
        u, v = rng.uniform(-a - 2, a + 2), rng.choice([-1.0, 1.0]) * (b + 1.5)
        spot = frame.at(u, v)
        site.plant(site.grounded(spot.north, spot.east, 0.0), scale=rng.uniform(0.5, 0.9))


def _build(site: Site, frame: Frame, half: tuple[float, float]) -> None:
    rng, (a, b) = site.rng, half
    draw = rng.random()

    def at(x: float, y: float) -> Frame:
        spot = frame.at(x, y)
        return site.grounded(spot.north, spot.east, frame.heading)

    if draw < 0.4:
        add_works(site, at(0.15 * a, -0.3 * b), (0.62 * a, 0.5 * b))
    elif draw < 0.75:
        add_hall(site, at(0.2 * a, -0.45 * b), (0.6 * a, 0.38 * b))
        add_hall(site, at(0.2 * a, 0.3 * b), (0.6 * a, 0.25 * b))
    elif draw < 0.88:
        for number in range(4):
            add_tank(
                site,
                at(0.1 * a + 0.6 * a * (number % 2), -0.6 * b + 0.45 * b * (number // 2)),
                rng.uniform(5.0, 8.0),
            )
    else:
        add_hall(site, at(0.55 * a, -0.5 * b), (0.35 * a, 0.4 * b))
    rows, columns = int(0.55 * a / 6.7), int(0.3 * b / 2.7)
    add_containers(site, at(-0.85 * a if draw < 0.88 else -0.4 * a, 0.62 * b), (rows, columns))


def _park(site: Site, frame: Frame, half: tuple[float, float]) -> None:
    """A row of parking bays with lines, most of them occupied."""
    rng, (a, b) = site.rng, half
    paint = site.painter
    left, count = -a + 3.0, int(1.1 * b / 2.6)
    paint.polygon(
        frame.rectangle((left - 1, -b + 3), (left + 5.5, -b + 3 + 2.6 * count)), Cover.ASPHALT
    )
    for bay in range(count + 1):
        y = -b + 3 + 2.6 * bay
        paint.band(frame.outline([(left, y), (left + 5.0, y)]), 0.12, Cover.MARKING)
        if bay < count and rng.random() < 0.65:
            spot = frame.at(left + 2.5, y + 1.3)
            turn = 0.0 if rng.random() < 0.5 else math.pi
            add_car(site.builder, rng, site.grounded(spot.north, spot.east, frame.heading + turn))
