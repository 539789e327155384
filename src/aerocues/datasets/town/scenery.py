"""The picture that `synthetic` uses by itself: the edge of a small town, seen from a drone.

It is drawn here, so it comes with the package under the package's own licence. Streets, roofs,
cars, crowns of trees and a field give the structure at all scales that detectors differ on.
About 15 cm a pixel; the sun stands in the south-east.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.town.houses import paint_house, paint_school
from aerocues.datasets.town.painting import (
    Canvas,
    Plane,
    Point,
    Window,
    convex,
    crown,
    disc,
    fractal_noise,
    rectangle,
    segment,
    value_noise,
)
from aerocues.datasets.town.streets import (
    CROSSING,
    LINE,
    STREET,
    paint_car,
    paint_parking,
    paint_streets,
    paint_traffic,
)

WIDTH, HEIGHT = 1000, 665
_SEED = 20260
_ANGLE = math.radians(7.0)
_SHADOW = (-0.62, -0.48)
_GRASS, _MEADOW, _EARTH = (92, 112, 62), (134, 138, 84), (146, 124, 94)
_LEAVES = ((58, 84, 42), (72, 98, 48), (48, 74, 46), (92, 104, 52), (104, 84, 48))


@lru_cache(maxsize=1)
def town() -> NDArray[np.uint8]:
    """Draw the picture: (665, 1000, 3) uint8 BGR, read-only, the same at every call.

    The last picture is kept, since every transformation of it starts from it again.
    """
    rng = np.random.default_rng(_SEED)
    canvas = Canvas(WIDTH, HEIGHT, _ANGLE)
    _ground(canvas, rng)
    _field(canvas, rng)
    paint_streets(canvas, rng)
    _court(canvas)
    paint_parking(canvas, rng, _SHADOW)
    paint_school(canvas, rng, (-330.0, 190.0), _SHADOW)
    _plots(canvas, rng)
    paint_traffic(canvas, rng, _SHADOW)
    _trees(canvas, rng)
    bgr = _camera(canvas.rgb, rng)
    bgr.setflags(write=False)
    return bgr


def _ground(canvas: Canvas, rng: np.random.Generator) -> None:
    shape = (HEIGHT, WIDTH)
    dryness = np.clip(0.4 + 0.45 * fractal_noise(rng, shape, 220, 14, 0.62), 0, 1)[..., None]
    bare = np.clip(1.6 * fractal_noise(rng, shape, 90, 6, 0.6) - 1.1, 0, 1)[..., None]
    tufts = 1 + 0.16 * fractal_noise(rng, shape, 7, 1.7, 0.9)[..., None]
    canvas.rgb[:] = np.array(_GRASS) + dryness * (np.array(_MEADOW) - np.array(_GRASS))
    canvas.rgb += 0.8 * bare * (np.array(_EARTH, dtype=np.float32) - canvas.rgb)
    canvas.rgb *= tufts


def _field(canvas: Canvas, rng: np.random.Generator) -> None:
    patches = 0.22 * fractal_noise(rng, (HEIGHT, WIDTH), 60, 3, 0.7)
    wobble = 2.2 * value_noise(rng, (HEIGHT, WIDTH), 70)

    def crop(u: Plane, v: Plane, at: Window) -> Plane:
        across = 0.94 * u - 0.34 * v + wobble[at]
        rows = 0.5 + 0.5 * np.sin(across * (2 * math.pi / 8.5)) + patches[at]
        tracks = np.abs((across % 96.0) - 12.0) < 1.7
        tracks |= np.abs((across % 96.0) - 24.0) < 1.7
        green = np.where(tracks, 0.0, np.clip(rows, 0, 1.2))[..., np.newaxis]
        soil, leaf = np.array([142, 116, 84]), np.array([104, 124, 52])
        return np.asarray(soil + green * (leaf - soil), dtype=np.float32)

    canvas.paint(convex([(240, 205), (700, 215), (700, 520), (215, 520)]), crop)
    canvas.paint(segment((236, 199), (720, 209), 11), (168, 148, 116), 0.9, soft=4)
    for offset in (-2.5, 2.5):
        start, end = (236, 199 + offset), (720, 209 + offset)
        canvas.paint(segment(start, end, 1.6), (128, 108, 82), 0.7, soft=2)


def _court(canvas: Canvas) -> None:
    """A tennis court beside the school."""
    center = (-440.0, -210.0)
    canvas.paint(rectangle(center, (118, 216)), (74, 104, 84))
    canvas.paint(rectangle(center, (76, 158)), (150, 82, 62))
    for across in (-38, -28.5, 28.5, 38):
        u = center[0] + across
        canvas.paint(segment((u, center[1] - 79), (u, center[1] + 79), 1.7), LINE)
    for along in (-79, -42, 42, 79):
        reach = 38 if abs(along) == 79 else 28.5
        v = center[1] + along
        canvas.paint(segment((center[0] - reach, v), (center[0] + reach, v), 1.7), LINE)
    canvas.paint(segment((center[0], center[1] - 42), (center[0], center[1] + 42), 1.7), LINE)
    canvas.shade(rectangle((center[0], center[1] - 3), (86, 5)), 0.6)
    canvas.paint(
        segment((center[0] - 43, center[1]), (center[0] + 43, center[1]), 2.2), (52, 54, 58)
    )


def _plots(canvas: Canvas, rng: np.random.Generator) -> None:
    """Houses in gardens on both sides of the street."""
    fronts = [(u, -1) for u in range(-62, 560, 112)] + [(u, 1) for u in range(-62, 560, 118)]
    fronts += [(-232, -1), (-332, -1)]
    for u, side in fronts:
        _plot(canvas, rng, (float(u), STREET + side * (112 + 16 * rng.random())), side)
    for u in range(-50, 600, 122):
        _plot(canvas, rng, (float(u), STREET - 262 - 14 * rng.random()), 1)


def _plot(canvas: Canvas, rng: np.random.Generator, center: Point, side: int) -> None:
    u, v = center
    lawn = np.array([100, 122, 64]) * (0.85 + 0.3 * rng.random())
    canvas.paint(rectangle((u, v), (102, 138)), lawn.tolist(), 0.35 + 0.3 * rng.random())
    stripes = 0.93 + 0.05 * rng.random()
    for stripe in range(6):
        canvas.shade(rectangle((u, v + side * (12 + 9 * stripe)), (96, 4.5)), stripes)
    drive = (u + 34, v - side * 48)
    canvas.paint(rectangle(drive, (19, 72)), (150, 142, 134))
    for step in range(9):
        joint = v - side * (16 + 8 * step)
        canvas.paint(segment((u + 25, joint), (u + 43, joint), 0.9), (112, 106, 100), 0.7)
    for step in range(7):  # stepping stones to the door
        canvas.paint(
            disc((u - 12 + 2 * rng.random(), v - side * (34 + 6 * step)), 2.1), (184, 178, 168)
        )
    if rng.random() < 0.7:
        paint_car(canvas, rng, (u + 34, v - side * (52 + 10 * rng.random())), math.pi / 2, _SHADOW)
    _garden(canvas, rng, center, side)
    size = (58 + 18 * rng.random(), 46 + 14 * rng.random())
    turn = 0.06 * (rng.random() - 0.5)
    paint_house(canvas, rng, (u - 6, v), size, turn, _SHADOW)


def _garden(canvas: Canvas, rng: np.random.Generator, center: Point, side: int) -> None:
    u, v = center
    hedge = [
        ((u - 51, v - 66), (u - 51, v + 66)),
        ((u - 51, v + 66 * side), (u + 51, v + 66 * side)),
    ]
    for start, end in hedge:
        canvas.shade(segment((start[0] - 3, start[1] - 2), (end[0] - 3, end[1] - 2), 6), 0.55)
        count = int(math.dist(start, end) / 4.2)
        for step in range(count):
            part = step / count
            place = (
                start[0] + part * (end[0] - start[0]) + rng.random() - 0.5,
                start[1] + part * (end[1] - start[1]) + rng.random() - 0.5,
            )
            green = np.array([62, 88, 46]) * (0.75 + 0.5 * rng.random())
            canvas.paint(disc(place, 2.4 + 0.8 * rng.random()), green.tolist())
    what = rng.random()
    place = (u - 22 + 10 * rng.random(), v + side * (46 + 4 * rng.random()))
    if what < 0.35:  # pool
        canvas.paint(rectangle(place, (34, 20), rounding=3), (198, 192, 182))
        canvas.paint(rectangle(place, (28, 14), rounding=2), (66, 150, 172))
        canvas.shade(rectangle((place[0], place[1] + 5), (28, 4)), 0.7)
    elif what < 0.7:  # vegetable beds
        for bed in range(4):
            at = (place[0] + 9.5 * bed - 14, place[1])
            canvas.paint(rectangle(at, (6.5, 22)), (104, 78, 56))
            for plant in range(5):
                canvas.paint(disc((at[0], at[1] - 8 + 4 * plant), 1.5), (86, 128, 58))
    else:  # shed
        canvas.shade(rectangle((place[0] - 5, place[1] - 4), (20, 15)), 0.5)
        canvas.paint(rectangle(place, (19, 14)), (132, 110, 90))
        canvas.paint(segment((place[0] - 9, place[1]), (place[0] + 9, place[1]), 1.2), (84, 70, 58))


def _trees(canvas: Canvas, rng: np.random.Generator) -> None:
    places = [*_street_trees(rng), *_garden_trees(rng), *_wood(rng)]
    for at, radius in sorted(places, key=lambda place: place[1]):
        if abs(at[1] - STREET) > 28:
            _tree(canvas, rng, at, radius)


def _street_trees(rng: np.random.Generator) -> list[tuple[Point, float]]:
    places = [
        ((u + 6 * rng.random(), STREET + 42 * side), 9 + 6 * rng.random())
        for u in range(-590, 600, 58)
        for side in (-1, 1)
        if abs(u - CROSSING) > 60 and rng.random() < 0.6
    ]
    crossing = [((CROSSING + 38, v + 5.0), 8 + 5 * rng.random()) for v in range(-330, 330, 44)]
    return places + crossing


def _garden_trees(rng: np.random.Generator) -> list[tuple[Point, float]]:
    places = [
        ((-90 + 680 * rng.random(), -330 + 470 * rng.random()), 7 + 11 * rng.random())
        for _ in range(46)
    ]
    return [(at, radius) for at, radius in places if abs(at[1] - STREET) > 60]


def _wood(rng: np.random.Generator) -> list[tuple[Point, float]]:
    places = [
        ((-580 + 170 * rng.random(), 20 + 400 * rng.random()), 13 + 13 * rng.random())
        for _ in range(70)
    ]
    return [(at, radius) for at, radius in places if at[1] > 60]


def _tree(canvas: Canvas, rng: np.random.Generator, center: Point, radius: float) -> None:
    lobes = [(0.09 * rng.random(), 6.3 * rng.random()) for _ in range(4)]
    shift = 0.75 * radius + 3
    shadow = (center[0] + shift * _SHADOW[0], center[1] + shift * _SHADOW[1])
    canvas.shade(crown(shadow, 0.95 * radius, lobes), 0.42, soft=2.5)
    leaf = np.array(_LEAVES[int(rng.random() ** 1.4 * len(_LEAVES))], dtype=np.float32)
    leaf *= 0.85 + 0.3 * rng.random()
    clumps = fractal_noise(rng, (64, 64), 9, 2.0, 0.8)
    origin = (center[0] - 32, center[1] - 32)

    def foliage(u: Plane, v: Plane, at: Window) -> Plane:
        row = np.clip(v - origin[1], 0, 63).astype(np.intp)
        column = np.clip(u - origin[0], 0, 63).astype(np.intp)
        toward_sun = ((center[0] - u) * _SHADOW[0] + (center[1] - v) * _SHADOW[1]) / radius
        light = 1.0 + 0.42 * toward_sun + 0.30 * clumps[row, column]
        return np.asarray(leaf * np.clip(light, 0.25, 2.0)[..., np.newaxis], dtype=np.float32)

    canvas.paint(crown(center, radius, lobes), foliage, soft=1.4)


def _camera(rgb: Plane, rng: np.random.Generator) -> NDArray[np.uint8]:
    """What a small camera makes of the scene: uneven light, a slight blur, noise, 8 bits."""
    light = 1 + 0.05 * fractal_noise(rng, (HEIGHT, WIDTH), 260, 120, 0.5)[..., np.newaxis]
    padded = np.pad(rgb * light, ((1, 1), (1, 1), (0, 0)), mode="edge")
    lines = 0.14 * (padded[:-2] + padded[2:]) + 0.72 * padded[1:-1]
    blurred = 0.14 * (lines[:, :-2] + lines[:, 2:]) + 0.72 * lines[:, 1:-1]
    noise = rng.random(blurred.shape, dtype=np.float32) + rng.random(
        blurred.shape, dtype=np.float32
    )
    exposed = 1.12 * blurred - 6.0 + 7.0 * (noise - 1.0)
    return np.ascontiguousarray(np.rint(np.clip(exposed, 0, 255)).astype(np.uint8)[..., ::-1])
