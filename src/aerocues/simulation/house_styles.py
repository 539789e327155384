"""Styles of houses: tables of materials and colours of roofs, walls and trim."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from aerocues.simulation.mesh import Colour, MeshBuilder
from aerocues.simulation.surfaces import Material

# Linear reflectances; the third column of the roofs is their share.
_WHITE: Colour = (0.62, 0.61, 0.58)
_ROOFS: tuple[tuple[Material, Colour, float], ...] = (
    (Material.SHINGLES, (0.130, 0.127, 0.125), 0.20),
    (Material.SHINGLES, (0.175, 0.160, 0.145), 0.16),
    (Material.SHINGLES, (0.150, 0.115, 0.092), 0.13),
    (Material.SHINGLES, (0.230, 0.210, 0.185), 0.09),
    (Material.TILES, (0.235, 0.110, 0.072), 0.12),
    (Material.TILES, (0.180, 0.095, 0.070), 0.10),
    (Material.TILES, (0.145, 0.140, 0.140), 0.08),
    (Material.TILES, (0.270, 0.175, 0.120), 0.07),
    (Material.METAL, (0.250, 0.260, 0.270), 0.05),
)
_WALLS: tuple[tuple[Material, Colour], ...] = (
    (Material.PLASTER, (0.55, 0.52, 0.46)),
    (Material.PLASTER, (0.48, 0.42, 0.33)),
    (Material.PLASTER, (0.60, 0.59, 0.56)),
    (Material.SIDING, (0.50, 0.52, 0.54)),
    (Material.SIDING, (0.33, 0.37, 0.40)),
    (Material.SIDING, (0.46, 0.45, 0.36)),
    (Material.BRICK, (0.27, 0.135, 0.095)),
    (Material.BRICK, (0.34, 0.23, 0.17)),
)


@dataclass(frozen=True)
class Style:
    """Surfaces of a house: roof, gables and walls, trim, glass, door."""

    roof: int
    wall: int
    trim: int
    glass: int
    door: int
    flat: int


@dataclass(frozen=True)
class Body:
    """A part of a house: half extents along x and y, height of the eaves, rise of the roof."""

    half: tuple[float, float]
    eaves: float
    rise: float
    hip: float


def varied(rng: np.random.Generator, colour: Colour, spread: float) -> Colour:
    """A random colour near the given one, mainly in brightness and slightly in hue."""
    tone = rng.uniform(1 - spread, 1 + spread)
    red, green, blue = (
        round(float(part * tone * rng.uniform(1 - spread / 3, 1 + spread / 3)), 3)
        for part in colour
    )
    return red, green, blue


def choose_style(builder: MeshBuilder, rng: np.random.Generator) -> Style:
    """Surfaces of one house."""
    shares = np.array([share for _, _, share in _ROOFS])
    material, colour, _ = _ROOFS[int(rng.choice(len(_ROOFS), p=shares / shares.sum()))]
    wall, wall_colour = _WALLS[int(rng.integers(len(_WALLS)))]
    doors: tuple[Colour, ...] = ((0.25, 0.06, 0.05), (0.08, 0.12, 0.2), (0.3, 0.2, 0.12), _WHITE)
    return Style(
        builder.surface(material, varied(rng, colour, 0.18)),
        builder.surface(wall, varied(rng, wall_colour, 0.12)),
        builder.surface(Material.PLAIN, varied(rng, _WHITE, 0.1)),
        builder.surface(Material.GLASS, (0.055, 0.07, 0.085)),
        builder.surface(Material.PLAIN, doors[int(rng.integers(len(doors)))]),
        builder.surface(Material.BITUMEN, varied(rng, (0.24, 0.23, 0.21), 0.3)),
    )
