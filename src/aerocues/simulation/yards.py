"""Objects in yards of farms and industry: halls, containers, tanks."""

from __future__ import annotations

import math

import numpy as np

from aerocues.simulation.house_styles import varied
from aerocues.simulation.houses import add_flat_roof
from aerocues.simulation.mesh import Colour
from aerocues.simulation.shapes import Frame, add_box, add_pole, add_roof
from aerocues.simulation.site import Site
from aerocues.simulation.surfaces import Material

_SHEETS: tuple[Colour, ...] = (
    (0.42, 0.43, 0.44), (0.30, 0.31, 0.32), (0.24, 0.28, 0.33), (0.36, 0.30, 0.24),
    (0.48, 0.46, 0.42),
)  # fmt: skip
_CONTAINERS: tuple[Colour, ...] = (
    (0.26, 0.07, 0.05), (0.05, 0.13, 0.28), (0.08, 0.20, 0.13), (0.42, 0.24, 0.06),
    (0.40, 0.40, 0.40), (0.20, 0.20, 0.21),
)  # fmt: skip
# Length, width and height of a standard 20-foot container in metres.
_CONTAINER = (6.06, 2.44, 2.59)


def add_hall(site: Site, frame: Frame, half: tuple[float, float]) -> None:
    """Add a sheet-metal hall with a low gable roof, skylights and vents."""
    builder, rng = site.builder, site.rng
    sheet = varied(rng, _SHEETS[int(rng.integers(len(_SHEETS)))], 0.15)
    roof = builder.surface(Material.METAL, sheet)
    wall = builder.surface(Material.SIDING, varied(rng, (0.42, 0.43, 0.43), 0.25))
    trim = builder.surface(Material.PLAIN, varied(rng, (0.3, 0.31, 0.32), 0.3))
    pale = builder.surface(Material.PLAIN, (0.46, 0.48, 0.46))
    turned = frame if half[0] <= half[1] else frame.at(0.0, 0.0, 0.0, math.pi / 2)
    short, long = min(half), max(half)
    eaves, rise = rng.uniform(5.0, 7.5), 0.18 * short
    add_box(builder, turned, (-short, -long, -2.0), (short, long, eaves), wall)
    add_roof(builder, turned, (short + 0.3, long + 0.3), eaves, rise, 0.0, (roof, wall, trim))
    for y in np.arange(-long + 3.0, long - 2.0, 6.0):
        for side in (-1.0, 1.0):
            points = [
                (side * short * x, y + w, eaves + rise * (1 - abs(x)) + 0.07)
                for x, w in ((0.25, 0.0), (0.75, 0.0), (0.75, 1.0), (0.25, 1.0))
            ]
            builder.quad(turned.place(np.array(points)), pale)
        if rng.random() < 0.4:
            add_pole(builder, turned.at(0.0, y + 2.0, eaves + rise), (0.4, 0.4), 0.8, trim)
    for y in np.arange(-long + 4.0, long - 3.0, 9.0):
        gate = np.array([(-short - 0.05, y, 0.0), (-short - 0.05, y + 4.0, 0.0),
                         (-short - 0.05, y + 4.0, 4.2), (-short - 0.05, y, 4.2)])  # fmt: skip
        builder.quad(turned.place(gate), trim)
    builder.finish_object()


def add_works(site: Site, frame: Frame, half: tuple[float, float]) -> None:
    """Add a flat-roofed building with skylights, air conditioners and pipes on its roof."""
    builder, rng = site.builder, site.rng
    wall = builder.surface(Material.PLASTER, varied(rng, (0.45, 0.44, 0.42), 0.2))
    edge = builder.surface(Material.PLAIN, varied(rng, (0.45, 0.45, 0.44), 0.2))
    roof = builder.surface(Material.BITUMEN, varied(rng, (0.27, 0.26, 0.245), 0.35))
    glass = builder.surface(Material.PLAIN, (0.42, 0.46, 0.48))
    height = float(rng.uniform(6.0, 11.0))
    add_flat_roof(builder, frame, half, height, (wall, edge, roof))
    for x in np.arange(-half[0] + 5.0, half[0] - 4.0, 9.0):
        for y in np.arange(-half[1] + 5.0, half[1] - 4.0, 8.0):
            draw, spot = rng.random(), frame.at(x, y, height)
            if draw < 0.55:
                add_box(builder, spot, (-0.9, -1.6, 0.0), (0.9, 1.6, 0.5), edge, 0.1)
                add_box(builder, spot, (-0.7, -1.4, 0.4), (0.7, 1.4, 0.56), glass, 0.05)
            elif draw < 0.75:
                size = rng.uniform(0.7, 1.8)
                add_box(builder, spot, (-size, -1.0, 0.0), (size, 1.0, rng.uniform(0.9, 2.0)), edge)
                add_pole(builder, spot.at(0.0, 0.0, 1.0), (0.5, 0.5), 1.2, roof, sides=10)
            elif draw < 0.82:
                add_box(builder, spot, (-4.0, -0.25, 0.2), (4.0, 0.25, 0.7), edge)
    builder.finish_object()


def add_containers(site: Site, frame: Frame, count: tuple[int, int]) -> None:
    """Add rows of identical containers, stacked up to three high."""
    builder, rng = site.builder, site.rng
    length, width, height = _CONTAINER
    for row in range(count[0]):
        for column in range(count[1]):
            place = frame.at(row * (length + 0.6), column * (width + 0.25))
            for level in range(int(rng.choice(4, p=[0.15, 0.4, 0.3, 0.15]))):
                colour = _CONTAINERS[int(rng.integers(len(_CONTAINERS)))]
                steel = builder.surface(Material.METAL, colour)
                low = level * height
                add_box(
                    builder,
                    place,
                    (0.0, 0.0, low - 0.1 * (level == 0)),
                    (length, width, low + height - 0.03),
                    steel,
                )
    builder.finish_object()


def add_tank(site: Site, frame: Frame, radius: float) -> None:
    """Add a round tank with a walkway."""
    builder = site.builder
    steel = builder.surface(Material.CONCRETE, varied(site.rng, (0.36, 0.36, 0.35), 0.15))
    dark = builder.surface(Material.PLAIN, (0.25, 0.25, 0.26))
    height = float(site.rng.uniform(5.0, 9.0))
    add_pole(builder, frame, (radius, radius), height, steel, sides=28, sink=1.5)
    add_pole(builder, frame.at(0, 0, height), (radius, 0.3), 0.12 * radius, steel, 28, 0.0)
    add_box(builder, frame, (-radius, -0.4, height + 0.1), (radius, 0.4, height + 0.9), dark)
    builder.finish_object()
