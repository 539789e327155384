"""A scene, and its state at a moment."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from aerocues.simulation.ground import Plan, Terrain
from aerocues.simulation.mesh import Mesh

# Seconds of one sway of the trees; images at intervals of multiples of it would show no motion.
_WIND_PERIOD = 2.7


@dataclass(frozen=True)
class Route:
    """A straight part of a street on which a car drives repeatedly.

    Parameters
    ----------
    member : int
        Number of the car's object in the mesh.
    north, east : float
        Velocity in metres per second.
    length : float
        Length in metres, after which the car starts again.
    start : float
        Position in metres at time 0.
    """

    member: int
    north: float
    east: float
    length: float
    start: float


@dataclass(frozen=True, eq=False)
class Scene:
    """A scene built from a seed.

    Parameters
    ----------
    name : str
    mesh : Mesh
        At time 0, in still air.
    plan : Plan
    terrain : Terrain
    half : float
        Extent of the details from the origin to each side, in metres.
    routes : tuple of Route
        Routes of the moving cars.
    leafy : (T,) bool
        Whether the wind moves a triangle.
    """

    name: str
    mesh: Mesh
    plan: Plan
    terrain: Terrain
    half: float
    routes: tuple[Route, ...]
    leafy: NDArray[np.bool_]

    def at(self, time: float, wind: float = 0.0) -> Mesh:
        """The mesh after `time` seconds, in a wind that moves crowns by `wind` metres."""
        if time == 0.0 and wind == 0.0:
            return self.mesh
        vertices = self.mesh.vertices.copy()
        for route in self.routes:
            first, stop = self.mesh.corners[route.member]
            speed = math.hypot(route.north, route.east)
            shift = (route.start + speed * time) % route.length - route.start
            there = vertices[first:stop, :2] + shift / speed * np.array([route.north, route.east])
            rise = self._height(there) - self._height(vertices[first:stop, :2])
            vertices[first:stop] = np.column_stack([there, vertices[first:stop, 2] - rise])
        if wind > 0.0:
            self._blow(vertices, time, wind)
        return replace(self.mesh, vertices=vertices)

    def _height(self, points: NDArray[np.floating]) -> NDArray[np.float64]:
        return self.terrain.height(points.astype(np.float64))

    def _blow(self, vertices: NDArray[np.float32], time: float, wind: float) -> None:
        moved = np.unique(self.mesh.triangles[self.leafy])
        north, east, down = vertices[moved].T
        above = np.clip(-down - self._height(vertices[moved, :2]), 0.0, 12.0) / 6.0
        phase = 2 * np.pi * time / _WIND_PERIOD + 0.7 * north + 0.5 * east
        vertices[moved, 0] += wind * above * np.sin(phase + 0.8 * down)
        vertices[moved, 1] += wind * above * np.cos(1.3 * phase - 0.6 * down)
