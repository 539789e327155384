"""The scene `suburb`: houses with gardens on bent streets, parks with ponds and courts."""

from __future__ import annotations

import itertools
import math

import numpy as np

from aerocues.simulation.gardens import add_furniture
from aerocues.simulation.ground import Cover
from aerocues.simulation.lots import Lot, furnish_lot, grow_meadow
from aerocues.simulation.scene import Scene
from aerocues.simulation.shapes import Frame
from aerocues.simulation.site import Site
from aerocues.simulation.streets import RESERVE, Grid

# Distances of the streets in metres, east-west and north-south, and widths of the lots: blocks with
# two rows of lots between the streets.
_ROW, _COLUMN = 168.0, 84.0
_LOTS = (17.0, 24.0)


def build_suburb(seed: int, half: float) -> Scene:
    """Build the scene; it extends `half` metres from the origin to each side."""
    rows, columns = _streets(half, _ROW, 31.0), _streets(half, _COLUMN, 22.0)
    site = Site("suburb", np.random.default_rng(seed), half, Grid(rows, columns, half))
    site.paint_streets()
    edges_u, edges_v = (-half, *rows, half), (-half, *columns, half)
    for i, (south, north) in enumerate(itertools.pairwise(edges_u)):
        for j, (west, east) in enumerate(itertools.pairwise(edges_v)):
            low = (south + RESERVE, west + RESERVE)
            high = (north - RESERVE, east - RESERVE)
            if min(high[0] - low[0], high[1] - low[1]) > 12.0:
                _fill_block(site, low, high, (5 * i + 3 * j + seed) % 13 == 4)
    site.line_streets(trees=True)
    return site.finish()


def _streets(half: float, spacing: float, first: float) -> tuple[float, ...]:
    count = int(2 * half / spacing) + 2
    at = first + spacing * np.arange(-count, count + 1)
    return tuple(float(street) for street in at[np.abs(at) < half - 20])


def _fill_block(
    site: Site, low: tuple[float, float], high: tuple[float, float], park: bool
) -> None:
    if park and high[1] - low[1] > 40.0:
        _lay_park(site, low, high)
        return
    depth = (high[1] - low[1]) / 2
    for front, side in ((low[1], 1.0), (high[1], -1.0)):
        at = low[0]
        while high[0] - at > 12.0:
            width = float(site.rng.uniform(*_LOTS))
            if high[0] - at - width < _LOTS[0]:
                width = min(high[0] - at, 30.0)
            lot = Lot(site, front, at + width / 2, side, width, depth)
            if depth < 26.0 or width < 15.5 or site.rng.random() < 0.05:
                grow_meadow(lot)
            else:
                furnish_lot(lot)
            at += width


def _lay_park(site: Site, low: tuple[float, float], high: tuple[float, float]) -> None:
    rng, paint = site.rng, site.painter
    middle = (low[0] + high[0]) / 2, (low[1] + high[1]) / 2
    heading = site.bend.heading(*middle, 0.0)
    paint.plot(heading, 0.4, (1.0, 1.0, 1.0))
    paint.polygon(site.quad_on_grid(low, high), Cover.LAWN)
    for _ in range(24):
        paint.plot(heading, rng.uniform(0.1, 0.8), tuple(rng.uniform(0.92, 1.08, 3)))
        spot = site.anywhere(low, high)
        paint.disc(
            (spot.north, spot.east),
            (rng.uniform(3, 14), rng.uniform(3, 9)),
            rng.uniform(0, 3),
            Cover.MEADOW if rng.random() < 0.4 else Cover.LAWN,
            0.18,
        )
    u, v = np.linspace(low[0], high[0], 40), np.linspace(0, 1, 40)
    for phase in rng.uniform(0, 2 * math.pi, 2):
        path = middle[1] + 0.36 * (high[1] - low[1]) * np.sin(2 * math.pi * v + phase)
        paint.band(site.bend.place(np.column_stack([u, path])), 2.0, Cover.GRAVEL)
    pond = site.frame(low[0] + 0.26 * (high[0] - low[0]), middle[1], 0.0)
    for grow, cover in ((3.4, Cover.GRAVEL), (1.4, Cover.MEADOW), (0.0, Cover.POND)):
        paint.disc((pond.north, pond.east), (21 + grow, 14 + grow), heading, cover, 0.12)
    court = site.frame(low[0] + 0.74 * (high[0] - low[0]), middle[1] + 6, 0.0)
    _lay_court(site, court)
    for _ in range(240):
        site.plant(site.anywhere(low, high), scale=rng.uniform(0.6, 1.15))


def _lay_court(site: Site, frame: Frame) -> None:
    """A tennis court with benches next to it."""
    paint = site.painter
    paint.polygon(frame.rectangle((-17.5, -8.8), (17.5, 8.8)), Cover.YARD)
    paint.polygon(frame.rectangle((-12.6, -6.2), (12.6, 6.2)), Cover.COURT)
    for across in (-5.5, -4.1, 0.0, 4.1, 5.5):
        reach = 6.4 if across == 0.0 else 11.9
        paint.band(frame.outline([(-reach, across), (reach, across)]), 0.12, Cover.MARKING)
    for along in (-11.9, -6.4, 6.4, 11.9):
        reach = 5.5 if abs(along) > 10 else 4.1
        paint.band(frame.outline([(along, -reach), (along, reach)]), 0.12, Cover.MARKING)
    for x in (-12.0, -4.0, 4.0, 12.0):
        add_furniture(site.builder, site.rng, frame.at(x, 8.0), "lounger")
    site.builder.finish_object()
