"""Objects in gardens: fences, sheds, pools and furniture."""

from __future__ import annotations

import itertools
import math

import numpy as np

from aerocues.simulation.ground import Cover, Painter, Terrain
from aerocues.simulation.mesh import Colour, MeshBuilder, Points
from aerocues.simulation.shapes import Frame, add_box, add_pole, add_roof, sphere
from aerocues.simulation.surfaces import Material

_FENCES: tuple[tuple[Colour, float], ...] = (
    ((0.20, 0.145, 0.10), 1.75),
    ((0.26, 0.22, 0.18), 1.6),
    ((0.13, 0.095, 0.07), 1.8),
    ((0.55, 0.54, 0.51), 1.15),
)
_CLOTH: tuple[Colour, ...] = (
    (0.45, 0.10, 0.08),
    (0.08, 0.22, 0.38),
    (0.60, 0.58, 0.50),
    (0.12, 0.28, 0.14),
    (0.55, 0.40, 0.10),
    (0.5, 0.5, 0.52),
)


def along_ground(terrain: Terrain, line: Points, step: float) -> Points:
    """Points (N, 3) on the ground at most `step` metres apart along a line (M, 2)."""
    parts = []
    for start, end in itertools.pairwise(line):
        count = max(math.ceil(float(np.linalg.norm(end - start)) / step), 1)
        parts.append(start + (end - start) * (np.arange(count) / count)[:, None])
    parts.append(line[-1:])
    return terrain.drape(np.concatenate(parts))


def add_fence(
    builder: MeshBuilder, rng: np.random.Generator, terrain: Terrain, line: Points
) -> None:
    """Add a fence of panels between posts that follows the ground along a line (M, 2)."""
    colour, height = _FENCES[int(rng.integers(len(_FENCES)))]
    wood = builder.surface(Material.WOOD, colour)
    points = along_ground(terrain, line, 2.2)
    for start, end in itertools.pairwise(points):
        across = np.array([-(end - start)[1], (end - start)[0], 0.0])
        across *= 0.04 / max(float(np.linalg.norm(across)), 1e-6)
        low, high = np.array([0.0, 0.0, -0.3]), np.array([0.0, 0.0, height])
        corners = [p + s * across + z for z in (low, high) for p in (start, end) for s in (-1, 1)]
        faces = np.array(
            [
                [0, 2, 6],
                [0, 6, 4],
                [1, 3, 7],
                [1, 7, 5],
                [4, 6, 7],
                [4, 7, 5],
                [0, 1, 5],
                [0, 5, 4],
                [2, 3, 7],
                [2, 7, 6],
            ]
        )
        builder.add(np.array(corners), faces, wood)
    for post in points:
        frame = Frame(float(post[0]), float(post[1]), float(post[2]), 0.0)
        add_box(builder, frame, (-0.07, -0.07, -0.3), (0.07, 0.07, height + 0.1), wood)
    builder.finish_object()


def add_shed(builder: MeshBuilder, rng: np.random.Generator, frame: Frame) -> None:
    """Add a garden shed."""
    wood = builder.surface(Material.WOOD, _FENCES[int(rng.integers(3))][0])
    tones = ((0.14, 0.14, 0.14), (0.16, 0.09, 0.06), (0.10, 0.13, 0.10))
    felt = builder.surface(Material.BITUMEN, tones[int(rng.integers(3))])
    a, b = rng.uniform(1.0, 1.5), rng.uniform(1.2, 2.2)
    add_box(builder, frame, (-a, -b, -0.5), (a, b, 2.0), wood)
    add_roof(builder, frame, (a + 0.2, b + 0.2), 2.0, 0.7, 0.0, (felt, wood, wood))
    builder.finish_object()


def add_pool(
    builder: MeshBuilder, rng: np.random.Generator, painter: Painter, frame: Frame
) -> None:
    """Paint a pool with a paved edge, and add loungers next to it."""
    a, b = rng.uniform(1.7, 2.4), rng.uniform(3.2, 4.6)
    turn = frame.heading + math.pi / 2
    if rng.random() < 0.5:
        painter.polygon(frame.rectangle((-a - 1.3, -b - 1.3), (a + 1.3, b + 1.3)), Cover.PAVERS)
        painter.polygon(frame.rectangle((-a - 0.3, -b - 0.3), (a + 0.3, b + 0.3)), Cover.KERB)
        painter.polygon(frame.rectangle((-a, -b), (a, b)), Cover.POOL)
    else:
        centre = (frame.north, frame.east)
        for grow, cover in ((1.2, Cover.PAVERS), (0.3, Cover.KERB), (0.0, Cover.POOL)):
            painter.disc(centre, (b + grow, a + grow), turn, cover, 0.05)
    for number in range(int(rng.integers(1, 4))):
        add_furniture(builder, rng, frame.at(a + 0.9, -1.5 + 1.4 * number), "lounger")


def add_furniture(builder: MeshBuilder, rng: np.random.Generator, frame: Frame, what: str) -> None:
    """Add a ``lounger``, ``table``, ``parasol``, ``trampoline``, ``box`` or ``bin``."""
    colour = builder.surface(Material.PLAIN, _CLOTH[int(rng.integers(len(_CLOTH)))])
    dark = builder.surface(Material.PLAIN, (0.05, 0.05, 0.055))
    wood = builder.surface(Material.WOOD, (0.24, 0.16, 0.10))
    if what == "lounger":
        add_box(builder, frame, (-0.9, -0.32, 0.0), (0.9, 0.32, 0.35), colour)
    elif what == "table":
        add_box(builder, frame, (-0.9, -0.5, 0.6), (0.9, 0.5, 0.75), wood)
        for x, y in ((-0.6, -0.85), (0.6, -0.85), (-0.6, 0.85), (0.6, 0.85)):
            add_box(builder, frame, (x - 0.25, y - 0.25, 0.0), (x + 0.25, y + 0.25, 0.5), dark)
    elif what == "parasol":
        add_pole(builder, frame, (0.03, 0.03), 2.3, dark)
        add_pole(builder, frame.at(0, 0, 2.0), (1.5, 0.05), 0.6, colour, sides=8, sink=0.0)
    elif what == "trampoline":
        add_pole(builder, frame, (1.6, 1.6), 0.7, colour, sides=14)
        add_pole(builder, frame, (1.35, 1.35), 0.74, dark, sides=14)
    elif what == "bin":
        add_box(builder, frame, (-0.3, -0.35, 0.0), (0.3, 0.35, 1.1), colour)
    else:
        add_box(builder, frame, (-1.0, -0.5, -0.2), (1.0, 0.5, 0.4), wood)
        soil = builder.surface(Material.BARK, (0.10, 0.075, 0.05))
        corners = np.array(
            [(-0.9, -0.4, 0.42), (0.9, -0.4, 0.42), (0.9, 0.4, 0.42), (-0.9, 0.4, 0.42)]
        )
        builder.quad(frame.place(corners), soil)


def add_boulder(builder: MeshBuilder, rng: np.random.Generator, frame: Frame) -> None:
    """Add a stone."""
    points, faces = sphere(4, 7)
    size = rng.uniform(0.2, 0.6)
    uneven = points * size * (1 + 0.2 * rng.standard_normal((len(points), 1))) * [1.0, 1.0, 0.6]
    builder.add(frame.place(uneven), faces, builder.surface(Material.CONCRETE, (0.26, 0.25, 0.23)))


def add_lamp(builder: MeshBuilder, frame: Frame) -> None:
    """Add a street lamp with its arm along x."""
    steel = builder.surface(Material.PLAIN, (0.25, 0.26, 0.27))
    add_pole(builder, frame, (0.10, 0.06), 7.0, steel, sides=5)
    add_box(builder, frame, (0.0, -0.05, 6.9), (1.8, 0.05, 7.0), steel)
    add_box(builder, frame, (1.4, -0.15, 6.85), (2.1, 0.15, 7.02), steel)
    builder.finish_object()
