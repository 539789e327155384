"""Cars and vans: bodies with a bonnet, a cabin of glass and wheels."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from aerocues.simulation.mesh import Colour, MeshBuilder
from aerocues.simulation.shapes import Frame, add_box
from aerocues.simulation.surfaces import Material

_PAINTS: tuple[Colour, ...] = (
    (0.60, 0.60, 0.60),
    (0.55, 0.55, 0.53),
    (0.30, 0.31, 0.32),
    (0.16, 0.165, 0.17),
    (0.035, 0.035, 0.038),
    (0.05, 0.05, 0.055),
    (0.28, 0.03, 0.03),
    (0.05, 0.10, 0.26),
    (0.10, 0.14, 0.20),
    (0.32, 0.28, 0.20),
    (0.06, 0.11, 0.08),
    (0.40, 0.20, 0.05),
)


@dataclass(frozen=True)
class CarKind:
    """Length, width and height in metres; start and end of the cabin as shares of the length."""

    length: float
    width: float
    height: float
    cabin: tuple[float, float]


KINDS = (
    CarKind(4.2, 1.8, 1.45, (0.12, 0.74)),
    CarKind(4.6, 1.85, 1.45, (0.24, 0.74)),
    CarKind(4.7, 1.95, 1.75, (0.06, 0.76)),
    CarKind(5.3, 2.0, 2.1, (0.03, 0.86)),
)


def add_car(builder: MeshBuilder, rng: np.random.Generator, frame: Frame) -> int:
    """Add a car that faces along x, and return the number of its object."""
    kind = KINDS[int(rng.choice(len(KINDS), p=[0.34, 0.36, 0.2, 0.1]))]
    paint = builder.surface(Material.PLAIN, _PAINTS[int(rng.integers(len(_PAINTS)))])
    glass = builder.surface(Material.GLASS, (0.035, 0.042, 0.05))
    tyre = builder.surface(Material.PLAIN, (0.03, 0.03, 0.03))
    a, b = kind.length / 2, kind.width / 2
    waist = 0.62 * kind.height
    add_box(builder, frame, (-a, -b, 0.25), (a, b, 0.75 * waist), paint, -0.02)
    add_box(
        builder,
        frame,
        (-a + 0.02, -b + 0.02, 0.75 * waist),
        (a - 0.02, b - 0.02, waist),
        paint,
        0.12,
    )
    rear, front = (-a + part * kind.length for part in kind.cabin)
    sides = b - 0.14
    add_box(builder, frame, (rear, -sides, waist), (front, sides, kind.height - 0.06), glass, 0.2)
    add_box(
        builder,
        frame,
        (rear + 0.32, -sides + 0.17, kind.height - 0.08),
        (front - 0.42, sides - 0.17, kind.height),
        paint,
        0.05,
    )
    for x in (-0.6 * a, 0.62 * a):
        for y in (-b, b - 0.2):
            add_box(builder, frame, (x - 0.33, y, -0.1), (x + 0.33, y + 0.2, 0.62), tyre, 0.03)
    return builder.finish_object()
