"""Trees, bushes and hedges: lobes of leaves around a trunk; kinds as a table."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aerocues.simulation.mesh import Colour, MeshBuilder, Points
from aerocues.simulation.shapes import Frame, add_pole, sphere
from aerocues.simulation.surfaces import Material

_BARK: Colour = (0.115, 0.09, 0.07)
# Crowns per kind: more make trees more different, and take longer to build.
_VARIANTS = 5


@dataclass(frozen=True)
class TreeKind:
    """One row of the table.

    Parameters
    ----------
    name : str
    height : tuple of float
        Minimum and maximum in metres.
    spread : float
        Diameter of the crown relative to the height.
    bare : float
        Share of the height below the crown.
    shape : str
        ``round``, ``cone`` or ``column``.
    lobes : int
        Number of leaf masses.
    leaf : float
        Side of a leaf cluster relative to the diameter of the crown.
    colour : tuple of float
        Linear reflectance of leaves.
    share : float
        Relative frequency in gardens.
    """

    name: str
    height: tuple[float, float]
    spread: float
    bare: float
    shape: str
    lobes: int
    leaf: float
    colour: Colour
    share: float


KINDS: tuple[TreeKind, ...] = (
    TreeKind("maple", (7, 12), 0.85, 0.25, "round", 16, 0.080, (0.085, 0.120, 0.035), 0.20),
    TreeKind("oak", (8, 14), 0.95, 0.22, "round", 22, 0.065, (0.070, 0.098, 0.036), 0.13),
    TreeKind("lime", (8, 13), 0.65, 0.22, "round", 14, 0.080, (0.105, 0.138, 0.042), 0.13),
    TreeKind("plum", (4, 6), 0.95, 0.25, "round", 9, 0.095, (0.105, 0.055, 0.048), 0.06),
    TreeKind("apple", (3.5, 5.5), 1.1, 0.25, "round", 9, 0.100, (0.110, 0.135, 0.062), 0.12),
    TreeKind("birch", (8, 12), 0.45, 0.22, "round", 12, 0.085, (0.120, 0.140, 0.050), 0.08),
    TreeKind("spruce", (8, 15), 0.40, 0.08, "cone", 32, 0.150, (0.045, 0.070, 0.040), 0.10),
    TreeKind("cypress", (4, 8), 0.30, 0.03, "column", 11, 0.200, (0.058, 0.085, 0.036), 0.06),
    TreeKind("bush", (0.9, 2.2), 1.4, 0.0, "round", 6, 0.210, (0.085, 0.112, 0.040), 0.12),
)
BY_NAME = {kind.name: kind for kind in KINDS}
_SHARES = np.array([kind.share for kind in KINDS])


@dataclass(frozen=True, eq=False)
class _Crown:
    """Leaves and inner masses of a tree of height 1 with its base at the origin."""

    leaves: Points
    masses: Points
    faces: NDArray[np.int64]


class Nursery:
    """Makes trees; each kind has a few crowns, which are rotated and scaled for each tree."""

    def __init__(self, rng: np.random.Generator) -> None:
        self._rng = rng
        self._crowns = {kind.name: [_crown(rng, kind) for _ in range(_VARIANTS)] for kind in KINDS}

    def any_kind(self) -> TreeKind:
        """A random kind, with the frequencies of the table."""
        return KINDS[int(self._rng.choice(len(KINDS), p=_SHARES / _SHARES.sum()))]

    def add(
        self, builder: MeshBuilder, kind: TreeKind, frame: Frame, detail: float, scale: float = 1.0
    ) -> None:
        """Add a tree as a separate object; `detail` is the share of its leaves to draw."""
        rng = self._rng
        crown = self._crowns[kind.name][int(rng.integers(_VARIANTS))]
        height = rng.uniform(*kind.height) * scale
        turned = Frame(frame.north, frame.east, frame.height, rng.uniform(0, 2 * math.pi))
        stretch = height * np.array([rng.uniform(0.88, 1.12), rng.uniform(0.88, 1.12), 1.0])
        tone = rng.uniform(0.82, 1.18)
        warm = rng.uniform(0.85, 1.2)
        colour = tuple(
            round(part * tone * by, 3)
            for part, by in zip(kind.colour, (warm, 1.0, 1.0), strict=True)
        )
        leaf = builder.surface(Material.LEAF, (colour[0], colour[1], colour[2]))
        count = max(int(len(crown.leaves) * detail), 8)
        leaves = crown.leaves[:count]
        if detail < 1.0:  # fewer but larger leaves keep the density of the crown
            middle = leaves.mean(axis=1, keepdims=True)
            leaves = middle + (leaves - middle) / math.sqrt(detail)
        points = turned.place(leaves.reshape(-1, 3) * stretch)
        builder.add(points, np.arange(3 * count).reshape(-1, 3), leaf)
        builder.add(turned.place(crown.masses * stretch), crown.faces, leaf)
        if kind.bare > 0:
            bark = builder.surface(Material.BARK, _BARK)
            thick = 0.018 * height + 0.05
            add_pole(builder, turned, (thick, 0.5 * thick), 0.75 * height, bark)
        builder.finish_object()


def _crown(rng: np.random.Generator, kind: TreeKind) -> _Crown:
    centres, radii = _LOBES[kind.shape](rng, kind)
    leaves = _leaves(rng, kind, centres, radii)
    unit, faces = sphere()
    masses, indices = [], []
    for number, (centre, radius) in enumerate(zip(centres, radii, strict=True)):
        uneven = 0.80 * radius * (1 + 0.12 * rng.standard_normal((len(unit), 1)))
        masses.append(centre + unit * uneven)
        indices.append(faces + number * len(unit))
    return _Crown(leaves, np.concatenate(masses), np.concatenate(indices))


def _round(rng: np.random.Generator, kind: TreeKind) -> tuple[Points, NDArray[np.float64]]:
    """Lobes on an ellipsoid, with a larger one inside."""
    half = (1 - kind.bare) / 2
    direction = rng.standard_normal((kind.lobes, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    direction[:, 2] = direction[:, 2] * 0.75 + 0.15
    reach = rng.uniform(0.42, 0.72, (kind.lobes, 1))
    reach[0] = 0.0
    extent = np.array([kind.spread / 2, kind.spread / 2, half])
    centres = direction * reach * extent + [0.0, 0.0, kind.bare + half]
    radii = rng.uniform(0.28, 0.44, kind.lobes) * min(extent[0], 1.3 * half)
    radii[0] *= 1.5
    return centres, radii


def _cone(rng: np.random.Generator, kind: TreeKind) -> tuple[Points, NDArray[np.float64]]:
    """Branches in whorls, shorter towards the top."""
    level = np.linspace(0.02, 0.97, kind.lobes)
    around = np.arange(kind.lobes) * 2.4 + rng.uniform(0, 0.6, kind.lobes)
    reach = (1 - level) * kind.spread / 2 * rng.uniform(0.55, 0.85, kind.lobes)
    height = kind.bare + (1 - kind.bare) * level * 0.94
    centres = np.column_stack([reach * np.cos(around), reach * np.sin(around), height])
    return centres, 0.035 + 0.36 * (1 - level) * kind.spread / 2


def _column(rng: np.random.Generator, kind: TreeKind) -> tuple[Points, NDArray[np.float64]]:
    level = np.linspace(0.06, 0.93, kind.lobes)
    sway = rng.normal(0, 0.02, (kind.lobes, 2))
    radii = kind.spread / 2 * (0.55 + 0.45 * np.sin(math.pi * level**0.7))
    return np.column_stack([sway, kind.bare + (1 - kind.bare) * level]), radii


_LOBES = {"round": _round, "cone": _cone, "column": _column}


def _leaves(
    rng: np.random.Generator, kind: TreeKind, centres: Points, radii: NDArray[np.float64]
) -> Points:
    """Leaf clusters on the lobes, none inside another lobe: (L, 3, 3) triangles."""
    side = kind.leaf * kind.spread
    area = 4 * math.pi * radii**2
    counts = np.maximum((1.9 * area / (0.43 * side**2)).astype(int), 6)
    owner = np.repeat(np.arange(len(radii)), counts)
    outward = rng.standard_normal((len(owner), 3))
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    reach = radii[owner, None] * rng.uniform(0.88, 1.08, (len(owner), 1))
    middle = centres[owner] + outward * reach
    gap = np.linalg.norm(middle[:, None] - centres[None], axis=2) - 0.78 * radii
    gap[np.arange(len(owner)), owner] = 1.0
    kept = (gap > 0).all(axis=1) & (middle[:, 2] > 0.02)
    middle, outward = middle[kept], outward[kept]
    order = rng.permutation(len(middle))
    middle, outward = middle[order], outward[order]
    normal = outward + 0.55 * rng.standard_normal(outward.shape) + [0.0, 0.0, 0.35]
    first = np.cross(normal, rng.standard_normal(normal.shape))
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    second = np.cross(normal, first)
    second /= np.linalg.norm(second, axis=1, keepdims=True)
    around = rng.uniform(0, 2 * math.pi, (len(middle), 1)) + np.array([[0.0, 2.1, 4.2]])
    around += rng.normal(0, 0.3, around.shape)
    size = side * rng.uniform(0.35, 0.85, around.shape)
    u, v = size * np.cos(around), size * np.sin(around)
    return np.asarray(
        middle[:, None] + u[..., None] * first[:, None] + v[..., None] * second[:, None]
    )


def add_hedge(
    builder: MeshBuilder,
    rng: np.random.Generator,
    line: Points,
    width: float,
    height: float,
    colour: Colour,
    detail: float,
) -> None:
    """Add a trimmed hedge along a line (N, 3) on the ground: leaves on a core."""
    leaf = builder.surface(Material.LEAF, colour)
    for start, end in itertools.pairwise(line):
        length = float(np.linalg.norm(end - start))
        if length < 0.2:
            continue
        along = (end - start) / length
        across = np.array([-along[1], along[0], 0.0])
        count = int(length * (2 * height + width) * 9 * detail)
        girth = rng.uniform(0, 2 * height + width, count)
        # Around the hedge: up one side, over the top, down the other.
        side = np.clip(girth - height, 0, width) - width / 2
        up = np.clip(np.minimum(girth, 2 * height + width - girth), 0.05, height)
        middle = start + along * rng.uniform(0, length, (count, 1)) + across * side[:, None]
        middle[:, 2] += up + 0.05 * rng.standard_normal(count)
        spread = 0.24 / math.sqrt(detail)
        leaves = middle[:, None] + spread * rng.standard_normal((count, 3, 3))
        builder.add(leaves.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3), leaf)
        frame = Frame(
            float(start[0]), float(start[1]), float(start[2]), math.atan2(along[1], along[0])
        )
        low, high = -0.46 * width, 0.46 * width
        points = [
            (x, y, z) for x in (0.0, length) for y in (low, high) for z in (-0.3, 0.9 * height)
        ]
        corners = frame.place(np.array(points))
        corners[4:, 2] += end[2] - start[2]
        faces = np.array(
            [
                [1, 3, 7],
                [1, 7, 5],
                [0, 1, 5],
                [0, 5, 4],
                [2, 3, 7],
                [2, 7, 6],
                [0, 1, 3],
                [0, 3, 2],
                [4, 5, 7],
                [4, 7, 6],
            ]
        )
        builder.add(corners, faces, leaf)
    builder.finish_object()
