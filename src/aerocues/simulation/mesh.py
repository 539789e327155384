"""Triangles of a scene, collected object by object."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]
Colour = tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class Mesh:
    """All triangles of a scene.

    Parameters
    ----------
    vertices : (V, 3) float32
        North, east, down in metres.
    triangles : (T, 3) int32
        Rows of `vertices`; both sides are visible.
    surface : (T,) int32
        Row of the triangle in `kinds` and `colours`.
    kinds : (S,) int32
        `Material` of each surface.
    colours : (S, 3) float32
        Linear reflectance of each surface.
    objects : (O, 2) int32
        First triangle and end of the triangles of each object; objects are culled as a whole.
    corners : (O, 2) int32
        First vertex and end of the vertices of each object.
    """

    vertices: NDArray[np.float32]
    triangles: NDArray[np.int32]
    surface: NDArray[np.int32]
    kinds: NDArray[np.int32]
    colours: NDArray[np.float32]
    objects: NDArray[np.int32]
    corners: NDArray[np.int32]


@dataclass
class MeshBuilder:
    """Collects triangles; positions are north, east and *height* (up).

    `finish_object` ends an object: everything added since the previous one.
    """

    _vertices: list[NDArray[np.float32]] = field(default_factory=list)
    _triangles: list[NDArray[np.int32]] = field(default_factory=list)
    _surface: list[NDArray[np.int32]] = field(default_factory=list)
    _surfaces: dict[tuple[int, Colour], int] = field(default_factory=dict)
    _ends: list[tuple[int, int]] = field(default_factory=lambda: [(0, 0)])
    _count: int = 0
    _count_triangles: int = 0

    def surface(self, kind: int, colour: Colour) -> int:
        """The number of a surface; the same for equal material and colour."""
        return self._surfaces.setdefault((int(kind), colour), len(self._surfaces))

    def add(
        self, points: Points, triangles: NDArray[np.int64], surface: int | NDArray[np.int32]
    ) -> None:
        """Add triangles (M, 3), rows of `points` (N, 3), with one surface for each or for all."""
        self._vertices.append(points.astype(np.float32))
        self._triangles.append((triangles + self._count).astype(np.int32))
        rows = np.empty(len(triangles), np.int32)
        rows[:] = surface
        self._surface.append(rows)
        self._count += len(points)
        self._count_triangles += len(triangles)

    def quad(self, corners: Points, surface: int) -> None:
        """Add a quadrilateral with (4, 3) corners in order."""
        self.add(corners, np.array([[0, 1, 2], [0, 2, 3]]), surface)

    def finish_object(self) -> int:
        """End an object and return its number; the previous number if nothing was added."""
        if self._ends[-1] != (self._count_triangles, self._count):
            self._ends.append((self._count_triangles, self._count))
        return len(self._ends) - 2

    def build(self) -> Mesh:
        """The mesh of everything added."""
        self.finish_object()
        vertices = np.concatenate(self._vertices)
        vertices[:, 2] *= -1.0
        ends = np.array(self._ends, np.int32)
        spans = np.stack([ends[:-1], ends[1:]], axis=2)
        return Mesh(
            vertices,
            np.concatenate(self._triangles),
            np.concatenate(self._surface),
            np.array([kind for kind, _ in self._surfaces], np.int32),
            np.array([colour for _, colour in self._surfaces], np.float32),
            np.ascontiguousarray(spans[:, 0]),
            np.ascontiguousarray(spans[:, 1]),
        )
