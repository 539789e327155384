"""The scene `fields`: crops and stubble in rows, tracks, hedgerows, a farm: repetitive."""

from __future__ import annotations

import math

import numpy as np

from aerocues.simulation.gardens import add_boulder, along_ground
from aerocues.simulation.ground import Cover
from aerocues.simulation.houses import add_house
from aerocues.simulation.scene import Scene
from aerocues.simulation.site import Site
from aerocues.simulation.streets import Grid
from aerocues.simulation.trees import BY_NAME, add_hedge
from aerocues.simulation.yards import add_hall

# Width of a parcel in metres: several are visible in one image from survey altitudes.
_PARCEL = (38.0, 85.0)
_HEDGEROW = ("oak", "maple", "bush", "bush", "bush", "birch")


def build_fields(seed: int, half: float) -> Scene:
    """Build the scene; it extends `half` metres from the origin to each side."""
    rng = np.random.default_rng([seed, 1])
    site = Site("fields", rng, half, Grid((-28.0,), (), half), relief=9.0)
    edges = -half
    while edges < half:
        depth = float(rng.uniform(70, 130))
        _lay_strip(site, edges, min(edges + depth, half))
        edges += depth
    _lay_tracks(site)
    site.paint_streets()
    _build_farm(site)
    return site.finish()


def _lay_strip(site: Site, south: float, north: float) -> None:
    """Parcels next to each other, each with its own crop and direction."""
    rng, west = site.rng, -site.half
    while west < site.half:
        east = min(west + float(rng.uniform(*_PARCEL)), site.half)
        angle = float(rng.choice([0.0, math.pi / 2])) + rng.normal(0, 0.12)
        dryness, tint = float(rng.beta(2, 2)), tuple(rng.uniform(0.86, 1.14, 3))
        site.painter.plot(angle, dryness, (tint[0], tint[1], tint[2]))
        crop = (Cover.CROP, Cover.STUBBLE, Cover.MEADOW)[int(rng.choice(3, p=[0.5, 0.28, 0.22]))]
        site.painter.polygon(site.quad_on_grid((south, west), (north, east)), crop)
        if rng.random() < 0.45:
            _plant_row(site, (south, east), (north, east))
        if rng.random() < 0.35:
            _plant_row(site, (north, west), (north, east))
        for _ in range(int(rng.integers(0, 4))):
            add_boulder(site.builder, rng, site.anywhere((south, west), (north, east)))
        site.builder.finish_object()
        west = east


def _plant_row(site: Site, start: tuple[float, float], end: tuple[float, float]) -> None:
    """Long grass with trees and bushes between two positions of the grid."""
    rng = site.rng
    steps = np.linspace(start, end, 20)
    site.painter.plot(0.0, 0.5, (1.0, 1.0, 1.0))
    site.painter.band(site.bend.place(steps), rng.uniform(2.5, 5.0), Cover.MEADOW)
    length = math.dist(start, end)
    for _ in range(int(length / rng.uniform(2.5, 7.0))):
        part, across = rng.random(), rng.normal(0, 0.7)
        u, v = (a + part * (b - a) + across for a, b in zip(start, end, strict=True))
        name = _HEDGEROW[int(rng.integers(len(_HEDGEROW)))]
        site.plant(site.frame(u, v, 0.0), BY_NAME[name], rng.uniform(0.7, 1.2))


def _lay_tracks(site: Site) -> None:
    """Tracks across the whole scene: two ruts with grass between them."""
    u = np.linspace(-site.half, site.half, 120)
    for at in np.arange(-site.half + 60, site.half, 150.0):
        winding = at + 6 * np.sin(u / 40 + at)
        site.painter.plot(0.0, 0.7, (1.0, 1.0, 1.0))
        site.painter.band(site.bend.place(np.column_stack([u, winding])), 3.4, Cover.MEADOW)
        for rut in (-0.8, 0.8):
            line = np.column_stack([u, winding + rut])
            site.painter.band(site.bend.place(line), 0.6, Cover.GRAVEL)


def _build_farm(site: Site) -> None:
    rng = site.rng
    yard = site.frame(14.0, 30.0, 0.0)
    site.painter.plot(yard.heading, 0.5, (0.95, 0.92, 0.88))
    site.painter.polygon(yard.rectangle((-26.0, -30.0), (24.0, 30.0)), Cover.GRAVEL)
    site.painter.polygon(yard.rectangle((-12.0, -16.0), (8.0, 16.0)), Cover.YARD)
    site.painter.polygon(yard.rectangle((-38.0, -3.0), (-20.0, 3.0)), Cover.GRAVEL)
    for x, y, half in ((14.0, 12.0, (8.0, 16.0)), (2.0, -22.0, (14.0, 6.0))):
        hall = yard.at(x, y)
        add_hall(site, site.grounded(hall.north, hall.east, yard.heading), half)
    house = yard.at(-17.0, 16.0)
    add_house(
        site.builder, rng, site.grounded(house.north, house.east, yard.heading), (4.8, 7.0), 3.4
    )
    fence = yard.outline([(-26.0, -31.0), (25.0, -31.0), (25.0, 31.0)])
    add_hedge(
        site.builder,
        rng,
        along_ground(site.terrain, fence, 3.0),
        1.2,
        1.8,
        (0.07, 0.1, 0.035),
        site.detail(yard),
    )
