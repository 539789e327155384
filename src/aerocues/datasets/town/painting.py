"""A canvas for drawing anti-aliased shapes with numpy alone, the same with every OpenCV.

Shapes are signed distances (negative inside, in pixels); a pixel's coverage follows from the
distance of its centre. Coordinates u, v of a scene are pixels turned about the canvas's centre.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Plane = NDArray[np.float32]
Color = Sequence[float]
Point = tuple[float, float]
Window = tuple[slice, slice]
Texture = Callable[[Plane, Plane, Window], Plane]
"""Colours (h, w, 3) from u, v and the window of the picture, (h, w) each, that they stand in."""


@dataclass(frozen=True)
class Shape:
    """A signed distance and the corners of a box around where it is negative."""

    distance: Callable[[Plane, Plane], Plane]
    box: tuple[float, float, float, float]


def rectangle(center: Point, size: Point, angle: float = 0.0, rounding: float = 0.0) -> Shape:
    """A rectangle turned by `angle` (radians), its corners rounded."""
    (cu, cv), half = center, (size[0] / 2 - rounding, size[1] / 2 - rounding)
    cos, sin = math.cos(angle), math.sin(angle)

    def distance(u: Plane, v: Plane) -> Plane:
        along = np.abs((u - cu) * cos + (v - cv) * sin) - half[0]
        across = np.abs((v - cv) * cos - (u - cu) * sin) - half[1]
        outside = np.hypot(np.maximum(along, 0), np.maximum(across, 0))
        inside = np.minimum(np.maximum(along, across), 0)
        return np.asarray(outside + inside - rounding, dtype=np.float32)

    reach_u = (abs(cos) * size[0] + abs(sin) * size[1]) / 2
    reach_v = (abs(sin) * size[0] + abs(cos) * size[1]) / 2
    return Shape(distance, (cu - reach_u, cv - reach_v, cu + reach_u, cv + reach_v))


def disc(center: Point, radius: float) -> Shape:
    """A filled circle."""
    cu, cv = center

    def distance(u: Plane, v: Plane) -> Plane:
        return np.asarray(np.hypot(u - cu, v - cv) - radius, dtype=np.float32)

    return Shape(distance, (cu - radius, cv - radius, cu + radius, cv + radius))


def crown(center: Point, radius: float, lobes: Sequence[Point]) -> Shape:
    """A disc whose edge waves: `lobes` are (amplitude, phase) of 3, 5, 8, 13 waves around it."""
    cu, cv = center

    def distance(u: Plane, v: Plane) -> Plane:
        around = np.arctan2(v - cv, u - cu)
        waves = sum(
            amplitude * np.sin(count * around + phase)
            for count, (amplitude, phase) in zip((3, 5, 8, 13), lobes, strict=True)
        )
        return np.asarray(np.hypot(u - cu, v - cv) - radius * (1 + waves), dtype=np.float32)

    reach = 1.5 * radius
    return Shape(distance, (cu - reach, cv - reach, cu + reach, cv + reach))


def segment(start: Point, end: Point, width: float) -> Shape:
    """A straight line with round ends."""
    center = ((start[0] + end[0]) / 2, (start[1] + end[1]) / 2)
    length = math.dist(start, end)
    angle = math.atan2(end[1] - start[1], end[0] - start[0])
    return rectangle(center, (length + width, width), angle, width / 2)


def convex(points: Sequence[Point]) -> Shape:
    """A convex polygon; its corners in either order."""
    middle = (sum(p[0] for p in points) / len(points), sum(p[1] for p in points) / len(points))

    def distance(u: Plane, v: Plane) -> Plane:
        farthest = np.full(u.shape, -np.inf, dtype=np.float32)
        for (au, av), (bu, bv) in zip(points, [*points[1:], points[0]], strict=True):
            length = math.hypot(bu - au, bv - av)
            if length < 1e-9:
                continue
            normal_u, normal_v = (bv - av) / length, (au - bu) / length
            inner = (middle[0] - au) * normal_u + (middle[1] - av) * normal_v
            sign = -1.0 if inner > 0 else 1.0
            edge = sign * ((u - au) * normal_u + (v - av) * normal_v)
            farthest = np.maximum(farthest, edge)
        return np.asarray(farthest, dtype=np.float32)

    us, vs = [p[0] for p in points], [p[1] for p in points]
    return Shape(distance, (min(us), min(vs), max(us), max(vs)))


class Canvas:
    """An RGB picture under work.

    Parameters
    ----------
    width, height : int
        Pixels.
    angle : float
        Radians by which the scene's axes u, v are turned against the picture's.
    """

    def __init__(self, width: int, height: int, angle: float) -> None:
        self.rgb = np.zeros((height, width, 3), dtype=np.float32)
        self._center = ((width - 1) / 2, (height - 1) / 2)
        self._cos, self._sin = math.cos(angle), math.sin(angle)
        x, y = np.meshgrid(
            np.arange(width, dtype=np.float32) - np.float32(self._center[0]),
            np.arange(height, dtype=np.float32) - np.float32(self._center[1]),
        )
        self.u = np.asarray(x * self._cos + y * self._sin, dtype=np.float32)
        self.v = np.asarray(y * self._cos - x * self._sin, dtype=np.float32)

    def paint(
        self, shape: Shape, paint: Color | Texture, opacity: float = 1.0, soft: float = 1.0
    ) -> None:
        """Lay a colour (RGB, 0 to 255) or a texture over a shape; `soft`: width of its edge."""
        window = self._window(shape.box, soft)
        u, v = self.u[window], self.v[window]
        if u.size == 0:
            return
        coverage = np.clip(0.5 - shape.distance(u, v) / soft, 0.0, 1.0) * opacity
        color = paint(u, v, window) if callable(paint) else np.asarray(paint, dtype=np.float32)
        self.rgb[window] += coverage[..., np.newaxis] * (color - self.rgb[window])

    def shade(self, shape: Shape, factor: float, soft: float = 1.5) -> None:
        """Darken what lies under a shape, as a shadow does; blue stays a little more than red."""
        window = self._window(shape.box, soft)
        u, v = self.u[window], self.v[window]
        if u.size == 0:
            return
        coverage = np.clip(0.5 - shape.distance(u, v) / soft, 0.0, 1.0)[..., np.newaxis]
        tint = np.array([factor, 1.04 * factor, 1.16 * factor], dtype=np.float32)
        self.rgb[window] *= 1 - coverage * (1 - tint)

    def _window(self, box: tuple[float, float, float, float], margin: float) -> Window:
        corners = [(u, v) for u in (box[0], box[2]) for v in (box[1], box[3])]
        xs = [u * self._cos - v * self._sin + self._center[0] for u, v in corners]
        ys = [u * self._sin + v * self._cos + self._center[1] for u, v in corners]
        height, width = self.u.shape
        left, right = math.floor(min(xs) - margin), math.ceil(max(xs) + margin) + 1
        top, bottom = math.floor(min(ys) - margin), math.ceil(max(ys) + margin) + 1
        return (
            slice(min(max(top, 0), height), min(max(bottom, 0), height)),
            slice(min(max(left, 0), width), min(max(right, 0), width)),
        )


def value_noise(rng: np.random.Generator, shape: tuple[int, int], cell: float) -> Plane:
    """Smooth noise from -1 to 1 with bumps about `cell` pixels wide."""
    height, width = shape
    rows, columns = math.ceil(height / cell) + 2, math.ceil(width / cell) + 2
    grid = (2 * rng.random((rows, columns)) - 1).astype(np.float32)
    vertical = _smooth_steps(height, cell)
    horizontal = _smooth_steps(width, cell)
    at, part = vertical
    lines = grid[at] * (1 - part[:, np.newaxis]) + grid[at + 1] * part[:, np.newaxis]
    at, part = horizontal
    return np.asarray(lines[:, at] * (1 - part) + lines[:, at + 1] * part, dtype=np.float32)


def _smooth_steps(length: int, cell: float) -> tuple[NDArray[np.intp], Plane]:
    position = np.arange(length, dtype=np.float32) / np.float32(cell)
    at = np.floor(position).astype(np.intp)
    part = position - at
    return at, np.asarray(part * part * (3 - 2 * part), dtype=np.float32)


def fractal_noise(
    rng: np.random.Generator, shape: tuple[int, int], coarse: float, fine: float, gain: float
) -> Plane:
    """Value noise summed over octaves from `coarse` to `fine` pixels, each `gain` of the last."""
    total = np.zeros(shape, dtype=np.float32)
    cell, weight = coarse, 1.0
    while cell >= fine:
        total += np.float32(weight) * value_noise(rng, shape, cell)
        cell, weight = cell / 2, weight * gain
    return total
