"""Streets, the car park and the cars of the drawn town."""

from __future__ import annotations

import math

import numpy as np

from aerocues.datasets.town.painting import (
    Canvas,
    Plane,
    Point,
    Window,
    disc,
    fractal_noise,
    rectangle,
    segment,
)

STREET, CROSSING = 8.0, -150.0
"""Where the street lies (its v) and the one that crosses it (its u)."""

LINE = (222, 221, 214)
_ASPHALT, _PAVING = (112, 112, 114), (162, 157, 148)
_CARS = (
    (226, 226, 224), (38, 40, 44), (150, 153, 158), (150, 34, 32), (44, 72, 122),
    (196, 196, 192), (92, 96, 98), (214, 176, 52), (36, 84, 60), (110, 62, 44),
)  # fmt: skip


def paint_streets(canvas: Canvas, rng: np.random.Generator) -> None:
    """The street and the one that crosses it, with pavements, mended places, cracks and lines."""
    grain = 1 + 0.055 * fractal_noise(rng, canvas.u.shape, 40, 1.6, 0.85)

    def asphalt(u: Plane, v: Plane, at: Window) -> Plane:
        worn = grain[at][..., np.newaxis]
        return np.asarray(np.array(_ASPHALT) * worn, dtype=np.float32)

    def paving(u: Plane, v: Plane, at: Window) -> Plane:
        joints = (np.abs(u % 7.0) < 1.0) | (np.abs(v % 7.0) < 1.0)
        stone = grain[at] * np.where(joints, 0.86, 1.0)
        return np.asarray(np.array(_PAVING) * stone[..., np.newaxis], dtype=np.float32)

    for surface, wide in ((paving, 70.0), (asphalt, 48.0)):
        canvas.paint(rectangle((0, STREET), (1400, wide)), surface)
        canvas.paint(rectangle((CROSSING, 0), (wide - 8, 1100)), surface)
    for _ in range(16):  # mended places
        u = -600 + 1200 * rng.random()
        v = STREET - 18 + 36 * rng.random()
        size = (14 + 40 * rng.random(), 6 + 12 * rng.random())
        canvas.paint(rectangle((u, v), size), (88, 88, 92), 0.75)
    for _ in range(26):  # tar in cracks
        u, v = -600 + 1200 * rng.random(), STREET - 21 + 42 * rng.random()
        end = (u - 25 + 50 * rng.random(), v - 10 + 20 * rng.random())
        canvas.paint(segment((u, v), end, 1.2), (62, 62, 66), 0.8)
    for u in range(-560, 600, 93):
        canvas.paint(disc((u, STREET + 9), 3.2), (70, 68, 66))
        canvas.paint(disc((u, STREET + 9), 1.9), (98, 94, 90))
    _road_lines(canvas)


def _road_lines(canvas: Canvas) -> None:
    for u in range(-580, 600, 34):
        if abs(u - CROSSING) > 48:
            canvas.paint(rectangle((u, STREET), (17, 2.0)), LINE, 0.85)
    for v in range(-480, 500, 34):
        if abs(v - STREET) > 52:
            canvas.paint(rectangle((CROSSING, v), (1.8, 16)), LINE, 0.8)
    for side in (-1, 1):  # zebra crossings and stop lines
        for step in range(7):
            along = (step - 3) * 6.2
            canvas.paint(rectangle((CROSSING + 37 * side, STREET + along), (13, 3.4)), LINE, 0.9)
            canvas.paint(
                rectangle((CROSSING + 0.85 * along, STREET + 40 * side), (3.2, 13)), LINE, 0.9
            )
        stop = (CROSSING + 49 * side, STREET + 11 * side)
        canvas.paint(rectangle(stop, (3.0, 20)), LINE, 0.9)


def paint_parking(canvas: Canvas, rng: np.random.Generator, shadow: Point) -> None:
    """Two rows of bays between the school and the crossing street."""
    center = (-218.0, 205.0)
    canvas.paint(rectangle(center, (76, 230)), (124, 122, 120))
    canvas.paint(rectangle((center[0], 92), (20, 30)), (124, 122, 120))
    for bay in range(14):
        v = center[1] - 104 + 16.0 * bay
        for side in (-1, 1):
            edge = center[0] + 37 * side
            canvas.paint(segment((edge - 24 * side, v), (edge, v), 1.3), LINE, 0.9)
            if bay < 13 and rng.random() < 0.62:
                place = (edge - 14 * side + 3 * rng.random(), v + 8 + rng.random())
                paint_car(canvas, rng, place, 0.05 * (rng.random() - 0.5), shadow)


def paint_traffic(canvas: Canvas, rng: np.random.Generator, shadow: Point) -> None:
    """Cars on the lanes and along the kerb."""
    for u in (-520, -408, -296, -58, 22, 141, 236, 318, 442):
        lane = STREET + (11 if rng.random() < 0.5 else -11)
        paint_car(canvas, rng, (u + 20 * rng.random(), lane), 0.03 * (rng.random() - 0.5), shadow)
    for u in range(-40, 560, 37):  # parked along the kerb
        if rng.random() < 0.45:
            paint_car(canvas, rng, (u + 4 * rng.random(), STREET + 20), 0.0, shadow)
    for v in (-260, -150, 120, 240):
        paint_car(
            canvas,
            rng,
            (CROSSING + (9 if v > 0 else -9), v + 20 * rng.random()),
            math.pi / 2,
            shadow,
        )


def paint_car(
    canvas: Canvas, rng: np.random.Generator, center: Point, angle: float, shadow: Point
) -> None:
    """A car of a random colour: body, windows, roof, lights and its shadow."""
    color = np.array(_CARS[int(rng.random() * len(_CARS))], dtype=np.float32)
    length, width = 27 + 5 * rng.random(), 11.5 + 1.5 * rng.random()
    u, v = center
    cos, sin = math.cos(angle), math.sin(angle)

    def part(along: float, size: Point, paint: tuple[float, ...], rounding: float = 1.0) -> None:
        at = (u + along * cos, v + along * sin)
        canvas.paint(rectangle(at, size, angle, rounding), paint)

    beside = (u + 5 * shadow[0], v + 5 * shadow[1])
    canvas.shade(rectangle(beside, (length, width), angle, 2.5), 0.45)
    part(0, (length, width), tuple(color * 0.92), 3)
    part(-0.06 * length, (0.62 * length, width - 1.6), (34, 38, 44), 2)
    part(-0.08 * length, (0.38 * length, width - 2.4), tuple(np.minimum(color * 1.12, 255)), 1.5)
    part(0.47 * length, (1.4, width - 3), (236, 232, 214), 0.5)
    part(-0.47 * length, (1.2, width - 3), (168, 40, 36), 0.5)
