"""Materials, and the pattern of each as a function of the position."""

from __future__ import annotations

import math
from enum import IntEnum

from aerocues.compiled import compiled
from aerocues.simulation.noise import fractal_noise, hashed, resolved

Rgb = tuple[float, float, float]


class Material(IntEnum):
    """Material of a triangle."""

    GROUND = 0
    TILES = 1
    SHINGLES = 2
    METAL = 3
    BITUMEN = 4
    PLASTER = 5
    BRICK = 6
    SIDING = 7
    GLASS = 8
    PLAIN = 9
    WOOD = 10
    LEAF = 11
    BARK = 12
    SOLAR = 13
    CONCRETE = 14


@compiled
def scaled(colour: Rgb, factor: float) -> Rgb:
    """A colour times a factor, which is at least 0.02."""
    factor = max(factor, 0.02)
    return colour[0] * factor, colour[1] * factor, colour[2] * factor


@compiled
def mixed(first: Rgb, second: Rgb, share: float) -> Rgb:
    """A mixture of two colours; `share` is that of the second."""
    share = min(max(share, 0.0), 1.0)
    return (
        first[0] + share * (second[0] - first[0]),
        first[1] + share * (second[1] - first[1]),
        first[2] + share * (second[2] - first[2]),
    )


@compiled
def joint(position: float, spacing: float, width: float, footprint: float) -> float:
    """Share of a pixel covered by joints of regular courses (box-filtered profile)."""
    reach = max(width, footprint)
    within = position / spacing - math.floor(position / spacing)
    distance = min(within, 1.0 - within) * spacing
    sharp = min(max((0.5 * (width + reach) - distance) / footprint, 0.0), 1.0) * width / reach
    # Joints closer than a pixel become a mean shade without a pattern.
    share = resolved(spacing, footprint)
    return share * sharp + (1.0 - share) * width / spacing


@compiled
def laid(
    colour: Rgb,
    u: float,
    v: float,
    size: tuple[float, float],
    contrast: tuple[float, float],
    footprint: float,
    seed: int,
) -> Rgb:
    """Courses of pieces, each with its own shade, and dark joints.

    Parameters
    ----------
    colour : tuple of float
    u, v : float
        Metres along and across the courses.
    size : tuple of float
        Length and height of a piece.
    contrast : tuple of float
        Contrast of the shades of pieces, and of the joints.
    footprint : float
        Side of a pixel in metres.
    seed : int
    """
    course = math.floor(v / size[1])
    shift = 0.5 * size[0] * (int(course) & 1) + 0.3 * size[0] * hashed(int(course), 5, seed)
    piece = math.floor((u + shift) / size[0])
    own = hashed(int(piece), int(course), seed) - 0.5
    # Groups of three pieces (from one pallet) remain visible from farther away than single pieces.
    group = hashed(int(piece) // 3, int(course) // 2, seed + 7) - 0.5
    shade = contrast[0] * own * resolved(2.0 * min(size[0], size[1]), footprint)
    shade += 0.8 * contrast[0] * group * resolved(4.0 * size[1], footprint)
    line = 0.75 * joint(v, size[1], 0.12 * size[1], footprint)
    line += 0.5 * joint(u + shift, size[0], 0.08 * size[0], footprint)
    return scaled(colour, 1.0 + shade - contrast[1] * line)


@compiled
def _roof(kind: int, colour: Rgb, u: float, v: float, footprint: float, seed: int) -> Rgb:
    weather = fractal_noise(u, v, 6.0, 0.2, 0.8, footprint, seed)
    streaks = fractal_noise(3.0 * u, 0.35 * v, 2.0, 0.25, 0.8, footprint, seed + 11)
    shade = 1.0 + 0.17 * weather + 0.12 * streaks
    if kind == Material.TILES:
        colour = laid(colour, u, v, (0.3, 0.36), (0.42, 0.75), footprint, seed)
    elif kind == Material.SHINGLES:
        colour = laid(colour, u, v, (0.5, 0.24), (0.5, 0.4), footprint, seed)
    elif kind == Material.METAL:
        colour = scaled(colour, 1.0 - 0.5 * joint(u, 0.6, 0.07, footprint))
        shade = 1.0 + 0.07 * weather + 0.08 * streaks
    else:
        seams = joint(u, 1.1, 0.05, footprint) + 0.5 * joint(v, 5.3, 0.06, footprint)
        grit = fractal_noise(u, v, 0.5, 0.06, 0.9, footprint, seed + 23)
        colour = scaled(colour, 1.0 - 0.3 * seams + 0.12 * grit)
        shade = 1.0 + 0.17 * weather
    moss = fractal_noise(u, v, 3.0, 0.3, 0.75, footprint, seed + 31)
    return mixed(scaled(colour, shade), (0.10, 0.105, 0.055), 0.55 * max(moss - 0.45, 0.0))


@compiled
def _wall(kind: int, colour: Rgb, u: float, height: float, footprint: float, seed: int) -> Rgb:
    stains = fractal_noise(2.0 * u, 0.6 * height, 3.0, 0.1, 0.75, footprint, seed)
    if kind == Material.BRICK:
        colour = laid(colour, u, height, (0.25, 0.085), (0.4, 0.5), footprint, seed)
    elif kind == Material.SIDING:
        colour = scaled(colour, 1.0 - 0.4 * joint(height, 0.22, 0.03, footprint))
    return scaled(colour, 1.0 + 0.09 * stains)


@compiled
def _foliage(
    colour: Rgb, triangle: int, x: float, y: float, height: float, footprint: float
) -> Rgb:
    leaf = hashed(triangle, 3, 11)
    tuft = fractal_noise(x + 0.6 * height, y - 0.6 * height, 1.6, 0.1, 0.85, footprint, 41)
    shade = 0.62 + 0.7 * leaf + 0.30 * tuft
    yellowed = mixed(colour, (0.20, 0.185, 0.055), 0.30 * hashed(triangle, 9, 12) ** 2)
    return scaled(yellowed, shade)


@compiled
def _panel(colour: Rgb, u: float, v: float, footprint: float) -> Rgb:
    frame = min(joint(u, 1.0, 0.05, footprint) + joint(v, 1.65, 0.05, footprint), 1.0)
    cells = min(joint(u, 0.166, 0.012, footprint) + joint(v, 0.166, 0.012, footprint), 1.0)
    glass = mixed(colour, (0.10, 0.12, 0.16), 0.5 * cells)
    return mixed(glass, (0.42, 0.43, 0.44), 0.8 * frame)


@compiled
def object_colour(
    kind: int, colour: Rgb, triangle: int, at: Rgb, normal: Rgb, footprint: float, seed: int
) -> Rgb:
    """Linear reflectance of a point of an object.

    Parameters
    ----------
    kind : int
        A `Material`.
    colour : tuple of float
        Colour of the surface.
    triangle : int
        Number of the triangle: each leaf differs.
    at, normal : tuple of float
        Position and unit normal: north, east, up.
    footprint : float
        Side of a pixel on the surface in metres.
    seed : int
        Seed of the surface.
    """
    x, y, height = at
    if kind == Material.LEAF:
        return _foliage(colour, triangle, x, y, height, footprint)
    level = math.hypot(normal[0], normal[1])
    # u is horizontal along the surface, v up the slope; both depend only on the normal.
    along = (-normal[1] / level, normal[0] / level) if level > 0.05 else (1.0, 0.0)
    u = x * along[0] + y * along[1]
    v = height / level if level > 0.05 else y
    if kind in (Material.TILES, Material.SHINGLES, Material.METAL, Material.BITUMEN):
        return _roof(kind, colour, u, v, footprint, seed)
    if kind in (Material.PLASTER, Material.BRICK, Material.SIDING):
        return _wall(kind, colour, u, height, footprint, seed)
    if kind == Material.SOLAR:
        return _panel(colour, u, v, footprint)
    if kind == Material.GLASS:
        return scaled(colour, 0.7 + 0.6 * hashed(triangle // 2, 1, 2))
    if kind in (Material.WOOD, Material.BARK):
        board = hashed(math.floor(u / 0.14), triangle // 12, 8) - 0.5
        grain = fractal_noise(3.0 * u, v, 1.5, 0.1, 0.8, footprint, 51)
        return scaled(colour, 1.0 + 0.5 * board * resolved(0.3, footprint) + 0.18 * grain)
    strength = 0.16 if kind == Material.CONCRETE else 0.04
    return scaled(colour, 1.0 + strength * fractal_noise(u, v, 2.0, 0.1, 0.8, footprint, seed))
