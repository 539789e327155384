"""The pattern of each ground cover as a function of the position."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from aerocues.compiled import compiled
from aerocues.simulation.ground import CELL, Cover, Plan
from aerocues.simulation.noise import fractal_noise, hashed, resolved
from aerocues.simulation.surfaces import Rgb, laid, mixed, scaled

TAPS = 3
"""Points per side of a pixel at which the plan is read: more smooth the edges between covers, and
shading takes longer with their square."""


@compiled
def _spots(x: float, y: float, side: float, share: float, footprint: float, seed: int) -> float:
    """Round spots in a share of the cells of a side in metres: 1 in the middle, 0 outside."""
    i, j = math.floor(x / side), math.floor(y / side)
    if hashed(i, j, seed) > share:
        return 0.0
    u = x / side - i - 0.22 - 0.56 * hashed(i, j, seed + 1)
    v = y / side - j - 0.22 - 0.56 * hashed(i, j, seed + 2)
    radius = 0.07 + 0.15 * hashed(i, j, seed + 3)
    return max(1.0 - (u * u + v * v) / (radius * radius), 0.0) * resolved(side, footprint)


@compiled
def _grass(x: float, y: float, footprint: float, plot: NDArray[np.float32], mown: bool) -> Rgb:
    broad = fractal_noise(x, y, 24.0, 1.5, 0.72, footprint, 101)
    fine = fractal_noise(x, y, 1.3, 0.05, 0.9, footprint, 131)
    dry = plot[1] + 0.34 * broad + 0.10 * fine
    green, straw = (0.070, 0.112, 0.034), (0.225, 0.192, 0.095)
    if not mown:
        green, straw = (0.080, 0.105, 0.036), (0.235, 0.200, 0.105)
    colour = mixed(green, straw, dry)
    shade = 1.0 + 0.12 * broad + 0.30 * fine
    if mown:
        across = x * math.sin(plot[0]) - y * math.cos(plot[0])
        stripe = 1.0 if (across / 1.1) % 2.0 < 1.0 else -1.0
        shade += 0.05 * stripe * resolved(2.2, footprint) * max(1.0 - plot[1], 0.0)
    else:
        shade += 0.14 * fractal_noise(x, y, 4.0, 0.6, 0.8, footprint, 171)
    bare = fractal_noise(x, y, 7.0, 0.2, 0.75, footprint, 151) - (0.95 - 0.35 * plot[1])
    colour = mixed(colour, (0.19, 0.145, 0.10), 1.4 * max(bare, 0.0))
    weeds = _spots(x, y, 0.9, 0.20, footprint, 161) + _spots(x, y, 2.3, 0.15, footprint, 165)
    colour = mixed(colour, (0.045, 0.075, 0.022), 0.75 * weeds)
    pale = _spots(x, y, 0.45, 0.07, footprint, 168)
    return mixed(scaled(colour, shade), (0.34, 0.33, 0.24), 0.55 * pale)


@compiled
def _asphalt(x: float, y: float, footprint: float, base: float) -> Rgb:
    wear = fractal_noise(x, y, 18.0, 0.8, 0.7, footprint, 201)
    grain = fractal_noise(x, y, 0.5, 0.04, 0.95, footprint, 211)
    shade = 1.0 + 0.13 * wear + 0.13 * grain
    # Cracks are the zero crossings of a noise.
    crack = abs(fractal_noise(x, y, 9.0, 0.5, 0.55, footprint, 221))
    shade -= 0.42 * max(1.0 - crack / 0.025, 0.0) * resolved(0.35, footprint)
    shade -= 0.45 * _spots(x, y, 2.7, 0.12, footprint, 231)
    shade += 0.22 * _spots(x, y, 1.3, 0.10, footprint, 241)
    return scaled((base, 0.985 * base, 0.96 * base), shade)


@compiled
def _slabs(
    x: float,
    y: float,
    footprint: float,
    plot: NDArray[np.float32],
    colour: Rgb,
    size: tuple[float, float],
    seed: int,
) -> Rgb:
    cos, sin = math.cos(plot[0]), math.sin(plot[0])
    u, v = x * cos + y * sin, y * cos - x * sin
    dirt = fractal_noise(x, y, 6.0, 0.06, 0.85, footprint, seed)
    spots = _spots(x, y, 1.1, 0.15, footprint, seed + 9)
    stone = laid(colour, u, v, size, (0.24, 0.55), footprint, seed)
    return scaled(stone, 1.0 + 0.14 * dirt - 0.3 * spots)


@compiled
def _rows(x: float, y: float, footprint: float, plot: NDArray[np.float32], green: bool) -> Rgb:
    """Rows of crop or stubble between bare soil, and tractor tracks."""
    wander = 0.25 * fractal_noise(x, y, 40.0, 10.0, 0.5, footprint, 301)
    across = x * math.sin(plot[0]) - y * math.cos(plot[0]) + wander
    along = x * math.cos(plot[0]) + y * math.sin(plot[0])
    patches = fractal_noise(x, y, 45.0, 2.0, 0.7, footprint, 311)
    fine = fractal_noise(x, y, 1.0, 0.05, 0.9, footprint, 321)
    spacing = 0.75 if green else 0.5
    plants = 0.5 + 0.5 * math.sin(2 * math.pi * across / spacing) * resolved(spacing, footprint)
    plants += 0.25 * fractal_noise(along, across, 0.8, 0.1, 0.9, footprint, 331)
    lane = across / 18.0 - math.floor(across / 18.0)
    track = abs(abs(lane - 0.5) * 18.0 - 0.9) < 0.28
    colour, leaf = (0.20, 0.155, 0.105), (0.075, 0.115, 0.030)
    if not green:
        colour, leaf = (0.24, 0.195, 0.125), (0.36, 0.30, 0.17)
    cover = 0.0 if track else plants + 0.30 * patches
    return scaled(mixed(colour, leaf, cover), 1.0 + 0.13 * patches + 0.15 * fine)


@compiled
def _water(x: float, y: float, footprint: float, pond: bool) -> Rgb:
    if pond:
        ripple = fractal_noise(x, y, 8.0, 0.2, 0.6, footprint, 401)
        return scaled((0.055, 0.075, 0.062), 1.0 + 0.22 * ripple)
    light = abs(fractal_noise(x, y, 0.9, 0.2, 0.6, footprint, 411))
    return scaled((0.13, 0.40, 0.47), 0.86 + 0.3 * max(1.0 - 4.0 * light, 0.0))


@compiled
def _soil(x: float, y: float, footprint: float) -> Rgb:
    clods = fractal_noise(x, y, 2.0, 0.05, 0.9, footprint, 501)
    plants = max(_spots(x, y, 0.6, 0.55, footprint, 511), _spots(x, y, 0.9, 0.3, footprint, 521))
    colour = scaled((0.125, 0.09, 0.062), 1.0 + 0.25 * clods)
    which = hashed(math.floor(x / 0.6), math.floor(y / 0.6), 531)
    leaf = (0.05, 0.085, 0.025)
    if which > 0.90:
        leaf = (0.42, 0.10, 0.16)
    elif which > 0.80:
        leaf = (0.45, 0.36, 0.08)
    return mixed(colour, leaf, 0.9 * plants)


@compiled
def _paved(cover: int, x: float, y: float, footprint: float, plot: NDArray[np.float32]) -> Rgb:
    if cover in (Cover.ASPHALT, Cover.PATCH, Cover.YARD):
        base = 0.105 if cover == Cover.ASPHALT else 0.07 if cover == Cover.PATCH else 0.15
        return _asphalt(x, y, footprint, base)
    if cover == Cover.PAVEMENT:
        return _slabs(x, y, footprint, plot, (0.30, 0.285, 0.26), (1.5, 1.8), 601)
    if cover == Cover.DRIVEWAY:
        return _slabs(x, y, footprint, plot, (0.29, 0.275, 0.25), (3.0, 2.6), 611)
    if cover == Cover.PAVERS:
        return _slabs(x, y, footprint, plot, (0.27, 0.215, 0.175), (0.6, 0.4), 621)
    grit = fractal_noise(x, y, 3.0, 0.05, 0.92, footprint, 701)
    if cover == Cover.MARKING:
        worn = fractal_noise(x, y, 1.5, 0.08, 0.9, footprint, 711)
        return mixed((0.58, 0.57, 0.53), (0.13, 0.13, 0.125), 0.9 * (worn - 0.1))
    if cover == Cover.GRAVEL:
        return scaled((0.31, 0.275, 0.225), 1.0 + 0.22 * grit)
    if cover == Cover.COURT:
        return scaled((0.17, 0.10, 0.075), 1.0 + 0.12 * grit)
    if cover == Cover.COVERLID:
        return scaled((0.06, 0.06, 0.06), 1.0 + 0.3 * grit)
    return scaled((0.36, 0.35, 0.32), 1.0 + 0.15 * grit)


@compiled
def cover_colour(
    cover: int, x: float, y: float, footprint: float, plot: NDArray[np.float32]
) -> Rgb:
    """Linear reflectance of one cover at a point: north and east in metres."""
    if cover in (Cover.LAWN, Cover.MEADOW):
        return _grass(x, y, footprint, plot, cover == Cover.LAWN)
    if cover == Cover.SOIL:
        return _soil(x, y, footprint)
    if cover in (Cover.POOL, Cover.POND):
        return _water(x, y, footprint, cover == Cover.POND)
    if cover in (Cover.CROP, Cover.STUBBLE):
        return _rows(x, y, footprint, plot, cover == Cover.CROP)
    return _paved(cover, x, y, footprint, plot)


@compiled
def _beyond(x: float, y: float) -> int:
    """The cover outside the plan: an irregular patchwork of fields and woods."""
    bent = x + 40.0 * math.sin(0.006 * y), y + 40.0 * math.sin(0.007 * x)
    return int(8 * hashed(math.floor(bent[0] / 130.0), math.floor(bent[1] / 190.0), 77))


@compiled
def _far_colour(x: float, y: float, footprint: float, plot: NDArray[np.float32]) -> Rgb:
    kind = _beyond(x, y)
    if kind < 2:
        clumps = fractal_noise(x, y, 9.0, 1.0, 0.8, footprint, 801)
        return scaled((0.040, 0.058, 0.024), 1.0 + 0.5 * clumps)
    if kind < 4:
        return _rows(x, y, footprint, plot, kind == 2)
    return _grass(x, y, footprint, plot, False)


@compiled
def ground_colour(plan: Plan, x: float, y: float, right: Rgb, down: Rgb, footprint: float) -> Rgb:
    """Linear reflectance of the ground under a pixel.

    Parameters
    ----------
    plan : Plan
    x, y : float
        North and east of the pixel's centre, metres.
    right, down : tuple of float
        Steps on the ground to the next column and to the next row: north, east, up.
    footprint : float
        Side of the pixel on the ground in metres.
    """
    red = green = blue = 0.0
    last_cover, last_plot, colour = -1, -1, (0.0, 0.0, 0.0)
    size = len(plan.cover)
    for tap in range(TAPS * TAPS):
        a, b = (tap // TAPS + 0.5) / TAPS - 0.5, (tap % TAPS + 0.5) / TAPS - 0.5
        north, east = x + a * right[0] + b * down[0], y + a * right[1] + b * down[1]
        row, column = int((north + plan.half) / CELL), int((east + plan.half) / CELL)
        if row < 0 or column < 0 or row >= size or column >= size:
            return _far_colour(x, y, footprint, plan.plots[0])
        cover, plot = int(plan.cover[row, column]), int(plan.plot[row, column])
        if cover != last_cover or plot != last_plot:
            settings = plan.plots[plot]
            colour = cover_colour(cover, x, y, footprint, settings)
            tint = settings[2], settings[3], settings[4]
            colour = colour[0] * tint[0], colour[1] * tint[1], colour[2] * tint[2]
            last_cover, last_plot = cover, plot
        red, green, blue = red + colour[0], green + colour[1], blue + colour[2]
    share = 1.0 / (TAPS * TAPS)
    return red * share, green * share, blue * share
