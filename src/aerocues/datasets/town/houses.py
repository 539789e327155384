"""Buildings of the drawn town: houses with tiled roofs, a flat-roofed school."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from aerocues.datasets.town.painting import (
    Canvas,
    Plane,
    Point,
    Texture,
    Window,
    convex,
    rectangle,
    segment,
)

_ROOFS = (
    (172, 92, 66), (150, 78, 58), (104, 104, 112), (86, 84, 90),
    (134, 112, 96), (186, 126, 94), (122, 72, 60), (168, 164, 158),
)  # fmt: skip
_Local = Callable[[float, float], Point]


def paint_house(
    canvas: Canvas,
    rng: np.random.Generator,
    center: Point,
    size: Point,
    angle: float,
    shadow: Point,
) -> None:
    """A house with a hipped or gabled roof; `shadow`: how far a shadow falls a unit of height."""
    color = np.array(_ROOFS[int(rng.random() * len(_ROOFS))], dtype=np.float32)
    color *= 0.9 + 0.2 * rng.random()
    half_u, half_v = size[0] / 2, size[1] / 2
    hip = half_v * (0.9 if rng.random() < 0.55 else 0.0)
    local = _frame(center, angle)
    corners = [(-half_u, -half_v), (half_u, -half_v), (half_u, half_v), (-half_u, half_v)]
    height = 24 + 8 * rng.random()
    _cast(canvas, [local(*corner) for corner in corners], (shadow[0] * height, shadow[1] * height))
    ridge = [(-half_u + hip, 0.0), (half_u - hip, 0.0)]
    faces = (
        ([corners[0], corners[1], ridge[1], ridge[0]], 0.74, "v"),
        ([corners[3], corners[2], ridge[1], ridge[0]], 1.16, "v"),
        ([corners[0], corners[3], ridge[0]], 0.86, "u"),
        ([corners[1], corners[2], ridge[1]], 1.05, "u"),
    )
    for points, light, slope in faces:
        if hip > 0 or slope == "v":
            tiles = _tiles(rng, color * light, center, angle, slope)
            canvas.paint(convex([local(*point) for point in points]), tiles)
    canvas.paint(segment(local(*ridge[0]), local(*ridge[1]), 1.6), (color * 0.62).tolist())
    if hip > 0:
        for corner, top in zip(corners, (ridge[0], ridge[1], ridge[1], ridge[0]), strict=True):
            canvas.paint(segment(local(*corner), local(*top), 1.1), (color * 0.7).tolist())
    _on_roof(canvas, rng, local, angle, (half_u, half_v), shadow)


def _frame(center: Point, angle: float) -> _Local:
    cos, sin = math.cos(angle), math.sin(angle)
    return lambda u, v: (center[0] + u * cos - v * sin, center[1] + u * sin + v * cos)


def _cast(canvas: Canvas, corners: list[Point], shift: Point) -> None:
    """The shadow of a block: its outline and the shifted one, and all between."""
    canvas.shade(convex(_hull(corners + [(u + shift[0], v + shift[1]) for u, v in corners])), 0.42)


def _hull(points: list[Point]) -> list[Point]:
    """Convex hull (Andrew's monotone chain)."""

    def chain(ordered: list[Point]) -> list[Point]:
        kept: list[Point] = []
        for p in ordered:
            while len(kept) > 1 and _turn(kept[-2], kept[-1], p) <= 0:
                kept.pop()
            kept.append(p)
        return kept[:-1]

    ordered = sorted(points)
    return chain(ordered) + chain(ordered[::-1])


def _turn(a: Point, b: Point, c: Point) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _tiles(
    rng: np.random.Generator, color: Plane, center: Point, angle: float, slope: str
) -> Texture:
    """Courses of tiles across the slope, each tile of a slightly different shade."""
    shades = (0.86 + 0.28 * rng.random((64, 64))).astype(np.float32)
    cos, sin = math.cos(angle), math.sin(angle)

    def paint(u: Plane, v: Plane, at: Window) -> Plane:
        along = (u - center[0]) * cos + (v - center[1]) * sin
        down = (v - center[1]) * cos - (u - center[0]) * sin
        if slope == "u":
            along, down = down, along
        course = np.floor(down / 3.4)
        tile = np.floor(along / 4.2 + 0.5 * (course % 2))
        shade = shades[course.astype(np.intp) % 64, tile.astype(np.intp) % 64]
        joint = np.where((down % 3.4) < 1.0, 0.78, 1.0)
        return np.asarray(color * (shade * joint)[..., np.newaxis], dtype=np.float32)

    return paint


def _on_roof(
    canvas: Canvas,
    rng: np.random.Generator,
    local: _Local,
    angle: float,
    half: Point,
    shadow: Point,
) -> None:
    chimney = local((rng.random() - 0.5) * half[0], (rng.random() - 0.7) * 0.5 * half[1])
    fallen = (chimney[0] + 9 * shadow[0], chimney[1] + 9 * shadow[1])
    canvas.shade(segment(chimney, fallen, 5), 0.5)
    canvas.paint(rectangle(chimney, (6.5, 5.5), angle), (146, 92, 78))
    canvas.paint(rectangle(chimney, (3.2, 2.6), angle), (38, 34, 34))
    for _ in range(int(3 * rng.random())):
        window = local((rng.random() - 0.5) * half[0], (0.35 + 0.3 * rng.random()) * half[1])
        canvas.paint(rectangle(window, (6.4, 7.4), angle), (208, 208, 206))
        canvas.paint(rectangle(window, (4.6, 5.6), angle), (70, 92, 116))
    if rng.random() < 0.4:
        _panels(canvas, local, angle, (-0.45 * half[0], 0.45 * half[1]), (4, 2))


def _panels(canvas: Canvas, local: _Local, angle: float, at: Point, count: tuple[int, int]) -> None:
    for column in range(count[0]):
        for row in range(count[1]):
            center = local(at[0] + 7.6 * column, at[1] + 9.4 * (row - 0.5))
            canvas.paint(rectangle(center, (7.2, 9.0), angle), (168, 172, 178))
            canvas.paint(rectangle(center, (6.0, 7.8), angle), (30, 40, 70))
            for part in (-1.3, 1.3):
                line = (
                    local(at[0] + 7.6 * column - 3, at[1] + 9.4 * (row - 0.5) + part),
                    local(at[0] + 7.6 * column + 3, at[1] + 9.4 * (row - 0.5) + part),
                )
                canvas.paint(segment(*line, 0.5), (96, 106, 132), 0.6)


def paint_school(canvas: Canvas, rng: np.random.Generator, center: Point, shadow: Point) -> None:
    """An L-shaped flat-roofed building with gravel, roof lights, air conditioners and panels."""
    wings = (((0.0, 0.0), (96.0, 196.0)), ((-66.0, -66.0), (92.0, 64.0)))
    local = _frame(center, 0.0)
    for (u, v), (width, depth) in wings:
        corners = [
            local(u + s * width / 2, v + t * depth / 2)
            for s, t in ((-1, -1), (1, -1), (1, 1), (-1, 1))
        ]
        _cast(canvas, corners, (34 * shadow[0], 34 * shadow[1]))
    stones = (0.9 + 0.2 * rng.random((256, 256))).astype(np.float32)

    def gravel(u: Plane, v: Plane, at: Window) -> Plane:
        shade = stones[np.floor(u).astype(np.intp) % 256, np.floor(v).astype(np.intp) % 256]
        seams = np.where((u % 32.0 < 1.2) | (v % 32.0 < 1.2), 0.9, 1.0)
        return np.asarray(np.array([176, 172, 164]) * (shade * seams)[..., np.newaxis], np.float32)

    for (u, v), size in wings:
        canvas.paint(rectangle(local(u, v), size), (206, 202, 194))
    for (u, v), (width, depth) in wings:
        canvas.shade(rectangle(local(u, v), (width - 5, depth - 5)), 0.6)
        canvas.paint(rectangle(local(u + 1, v + 1), (width - 7, depth - 7)), gravel)
    for row in range(6):
        _roof_light(canvas, local(-24.0, -74 + 29.0 * row), shadow)
    _panels(canvas, local, 0.0, (6.0, -62.0), (4, 4))
    _panels(canvas, local, 0.0, (6.0, 58.0), (4, 4))
    for _ in range(9):
        unit = local(-100 + 76 * rng.random(), -90 + 44 * rng.random())
        canvas.shade(rectangle((unit[0] + 6 * shadow[0], unit[1] + 6 * shadow[1]), (9, 9)), 0.5)
        canvas.paint(rectangle(unit, (8.5, 8.5)), (198, 200, 200))
        canvas.paint(rectangle(unit, (4.6, 4.6), rounding=2.2), (66, 68, 70))


def _roof_light(canvas: Canvas, center: Point, shadow: Point) -> None:
    canvas.shade(rectangle((center[0] + 4 * shadow[0], center[1] + 4 * shadow[1]), (16, 16)), 0.6)
    canvas.paint(rectangle(center, (16, 16)), (222, 222, 220))
    canvas.paint(rectangle(center, (12, 12)), (132, 156, 170))
    canvas.paint(
        segment((center[0] - 6, center[1]), (center[0] + 6, center[1]), 1), (210, 212, 212)
    )
    canvas.paint(
        segment((center[0], center[1] - 6), (center[0], center[1] + 6), 1), (210, 212, 212)
    )
