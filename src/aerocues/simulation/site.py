"""The base of all scenes: ground, streets and trees, and the rules for placing them."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field

import numpy as np

from aerocues.simulation.cars import add_car
from aerocues.simulation.gardens import add_lamp
from aerocues.simulation.ground import Cover, Painter, Terrain, add_terrain
from aerocues.simulation.mesh import MeshBuilder, Points
from aerocues.simulation.scene import Route, Scene
from aerocues.simulation.shapes import Frame
from aerocues.simulation.streets import CARRIAGEWAY, RESERVE, VERGE_END, Bend, Grid, paint_streets
from aerocues.simulation.surfaces import Material
from aerocues.simulation.trees import BY_NAME, Nursery, TreeKind

_SOFT = frozenset({Cover.LAWN, Cover.MEADOW, Cover.SOIL})


@dataclass
class Site:
    """A scene under construction; positions on the street grid are bent to world positions."""

    name: str
    rng: np.random.Generator
    half: float
    grid: Grid
    relief: float = 5.0
    bend: Bend = field(init=False)
    terrain: Terrain = field(init=False)
    painter: Painter = field(init=False)
    builder: MeshBuilder = field(init=False)
    nursery: Nursery = field(init=False)
    routes: list[Route] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.bend = Bend(self.rng.uniform(0, 2 * math.pi, 4))
        self.terrain = Terrain.from_seed(self.rng, self.relief)
        self.painter = Painter(self.half)
        self.builder = MeshBuilder()
        self.nursery = Nursery(self.rng)
        add_terrain(self.builder, self.terrain, self.half)

    def frame(self, u: float, v: float, direction: float, turn: float = 0.0) -> Frame:
        """A frame on the ground at a position and direction of the grid."""
        north, east = self.bend.place(np.array([[u, v]]))[0]
        return self.grounded(north, east, self.bend.heading(u, v, direction) + turn)

    def anywhere(self, low: tuple[float, float], high: tuple[float, float]) -> Frame:
        """A frame on the ground at a random position in a rectangle of the grid."""
        return self.frame(
            float(self.rng.uniform(low[0], high[0])), float(self.rng.uniform(low[1], high[1])), 0.0
        )

    def grounded(self, north: float, east: float, heading: float) -> Frame:
        """A frame on the ground at a position in the world."""
        height = float(self.terrain.height(np.array([[north, east]]))[0])
        return Frame(float(north), float(east), height, heading)

    def detail(self, frame: Frame) -> float:
        """Share of the leaves to draw: all where the cameras fly, fewer further away."""
        distance = math.hypot(frame.north, frame.east)
        return 1.0 if distance < 210 else 0.5 if distance < 300 else 0.25

    def quad_on_grid(self, low: tuple[float, float], high: tuple[float, float]) -> Points:
        """World outline of a rectangle of the grid, bent along its sides."""
        corners = [low, (high[0], low[1]), high, (low[0], high[1]), low]
        sides = [
            np.linspace(start, end, 12, endpoint=False)
            for start, end in itertools.pairwise(corners)
        ]
        return self.bend.place(np.concatenate(sides))

    def plant(self, frame: Frame, kind: TreeKind | None = None, scale: float = 1.0) -> bool:
        """Plant a tree if the ground is soft and no wall is near; return whether it was planted."""
        kind = kind or self.nursery.any_kind()
        clear = 0.0 if kind.name == "bush" else 0.22 * kind.spread * kind.height[1] * scale
        for step in range(9):
            reach = 0.0 if step == 8 else clear
            north = frame.north + reach * math.cos(step * math.pi / 4)
            east = frame.east + reach * math.sin(step * math.pi / 4)
            if max(abs(north), abs(east)) > self.half - 3.0:
                return False
            if self.painter.cover_at(north, east) not in _SOFT:
                return False
        self.nursery.add(self.builder, kind, frame, self.detail(frame), scale)
        return True

    def line_streets(self, trees: bool) -> None:
        """Add trees and lamps to the verges, and parked and moving cars."""
        for way, lines in ((True, self.grid.columns), (False, self.grid.rows)):
            direction = 0.0 if way else math.pi / 2
            for at in lines:
                for along in np.arange(-self.half + 8, self.half - 8, 7.5):
                    for side in (-1.0, 1.0):
                        self._beside(
                            way, at, along + self.rng.uniform(-2, 2), side, direction, trees
                        )
                for along in np.arange(-self.half + 40, self.half - 80, 75.0):
                    self._drive(way, at, along + self.rng.uniform(0, 30), direction)

    def _beside(
        self, way: bool, at: float, along: float, side: float, direction: float, trees: bool
    ) -> None:
        def on_grid(offset: float) -> tuple[float, float]:
            # The right side of a northbound street is east, of an eastbound street south.
            return (along, at + offset) if way else (at - offset, along)

        others = self.grid.rows if way else self.grid.columns
        if any(abs(other - along) < RESERVE + 4.0 for other in others):
            return
        verge = self.frame(*on_grid(side * 0.5 * (CARRIAGEWAY + VERGE_END)), direction)
        draw = self.rng.random()
        if trees and draw < 0.42 and self.painter.cover_at(verge.north, verge.east) == Cover.LAWN:
            name = ("maple", "lime", "plum", "birch", "oak")[int(self.rng.integers(5))]
            self.nursery.add(self.builder, BY_NAME[name], verge, self.detail(verge), 0.72)
        elif draw < 0.50:
            turn = math.pi / 2 if side < 0 else -math.pi / 2
            add_lamp(self.builder, verge.at(0.0, 0.0, 0.0, turn))
        elif draw > 0.84:
            place = self.frame(*on_grid(side * (CARRIAGEWAY - 1.05)), direction)
            add_car(self.builder, self.rng, place.at(0, 0, 0, 0.0 if side > 0 else math.pi))

    def _drive(self, way: bool, at: float, along: float, direction: float) -> None:
        if self.rng.random() < 0.4:
            return
        side = float(self.rng.choice([-1.0, 1.0]))
        offset = side * 1.3
        place = (along, at + offset) if way else (at - offset, along)
        frame = self.frame(*place, direction, 0.0 if side > 0 else math.pi)
        member = add_car(self.builder, self.rng, frame)
        speed = self.rng.uniform(6, 12)
        north, east = speed * math.cos(frame.heading), speed * math.sin(frame.heading)
        self.routes.append(Route(member, north, east, 30.0, self.rng.uniform(0, 5)))

    def paint_streets(self) -> None:
        """Paint the streets over the earlier covers."""
        paint_streets(self.painter, self.grid, self.bend, self.rng)

    def finish(self) -> Scene:
        """The scene as built so far."""
        mesh = self.builder.build()
        leafy = mesh.kinds[mesh.surface] == int(Material.LEAF)
        return Scene(
            self.name,
            mesh,
            self.painter.finish(),
            self.terrain,
            self.half,
            tuple(self.routes),
            leafy,
        )
