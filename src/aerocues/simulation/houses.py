"""Houses: walls with windows and doors, roofs of several kinds, and objects on roofs."""

from __future__ import annotations

import math

import numpy as np

from aerocues.simulation.house_styles import Body, Style, choose_style, varied
from aerocues.simulation.mesh import MeshBuilder
from aerocues.simulation.shapes import Frame, add_box, add_roof
from aerocues.simulation.surfaces import Material


def add_house(
    builder: MeshBuilder,
    rng: np.random.Generator,
    frame: Frame,
    half: tuple[float, float],
    garage: float,
) -> None:
    """Add a house whose front faces -x.

    Parameters
    ----------
    builder : MeshBuilder
    rng : numpy.random.Generator
    frame : Frame
        Its origin is the centre of the house on the ground.
    half : tuple of float
        Half of the depth (x) and of the width (y) in metres.
    garage : float
        Width of a garage at the right side (+y) in metres; 0: none.
    """
    style = choose_style(builder, rng)
    storeys = 1 if rng.random() < 0.55 else 2
    eaves = 0.4 + 2.75 * storeys
    if rng.random() < 0.09:
        _add_flat_roofed(builder, rng, frame, half, eaves, style)
    else:
        _add_pitched(builder, rng, frame, half, eaves, style)
    _add_windows(builder, frame, half, storeys, style)
    if garage > 0:
        _add_garage(builder, rng, frame.at(-half[0] + 3.2, half[1] + garage / 2), garage, style)
    step = frame.at(-half[0] - 0.7, -0.3 * half[1])
    stone = builder.surface(Material.CONCRETE, (0.33, 0.31, 0.28))
    add_box(builder, step, (-0.8, -1.0, -0.5), (0.8, 1.0, 0.25), stone)
    builder.finish_object()


def _add_pitched(
    builder: MeshBuilder,
    rng: np.random.Generator,
    frame: Frame,
    half: tuple[float, float],
    eaves: float,
    style: Style,
) -> None:
    slope = math.tan(math.radians(rng.uniform(24, 42)))
    lengthwise = half[0] <= half[1] * rng.uniform(0.9, 1.3)
    main = frame if lengthwise else frame.at(0.0, 0.0, 0.0, math.pi / 2)
    short, long = half if lengthwise else half[::-1]
    rise = slope * (short + 0.45)
    hip = (short + 0.45) * rng.uniform(0.85, 1.0) if rng.random() < 0.42 else 0.0
    hip = min(hip, long * 0.85)
    _add_body(builder, main, Body((short, long), eaves, rise, hip), style)
    if rng.random() < 0.6:  # a wing across the main ridge
        wing = min(0.42 * long, 0.72 * short)
        side = rng.choice([-1.0, 1.0]) * (long - wing - 0.3)
        reach = rng.uniform(1.5, 3.2)
        across = main.at(-(short / 2 + reach / 2), side, 0.0, math.pi / 2)
        body = Body((wing, short / 2 + reach / 2), eaves, slope * (wing + 0.45), 0.0)
        _add_body(builder, across, body, style)
    _add_on_roof(builder, rng, main, Body((short + 0.45, long), eaves, rise, hip), style)


def _add_body(builder: MeshBuilder, frame: Frame, body: Body, style: Style) -> None:
    (a, b), overhang = body.half, 0.45
    add_box(builder, frame, (-a, -b, -1.5), (a, b, body.eaves), style.wall)
    if body.hip == 0:  # a gable: the wall reaches the ridge
        under = body.eaves + body.rise * overhang / (a + overhang)
        for end in (-b, b):
            points = np.array(
                [
                    (-a, end, body.eaves),
                    (a, end, body.eaves),
                    (a, end, under),
                    (0.0, end, body.eaves + body.rise),
                    (-a, end, under),
                ]
            )
            faces = np.array([[0, 1, 2], [0, 2, 4], [2, 3, 4]])
            builder.add(frame.place(points), faces, style.wall)
    half = (a + overhang, b + overhang)
    add_roof(
        builder, frame, half, body.eaves, body.rise, body.hip, (style.roof, style.wall, style.trim)
    )


def _add_flat_roofed(
    builder: MeshBuilder,
    rng: np.random.Generator,
    frame: Frame,
    half: tuple[float, float],
    eaves: float,
    style: Style,
) -> None:
    add_flat_roof(builder, frame, half, eaves + 0.3, (style.wall, style.trim, style.flat))
    for _ in range(int(rng.integers(2, 5))):
        unit = frame.at(
            rng.uniform(-0.6, 0.6) * half[0], rng.uniform(-0.6, 0.6) * half[1], eaves + 0.3
        )
        size = rng.uniform(0.3, 0.8)
        add_box(builder, unit, (-size, -size, 0), (size, size, rng.uniform(0.3, 0.9)), style.trim)


def add_flat_roof(
    builder: MeshBuilder,
    frame: Frame,
    half: tuple[float, float],
    height: float,
    surfaces: tuple[int, int, int],
) -> None:
    """Add a block with a flat roof behind a parapet; surfaces of wall, parapet and roof."""
    (a, b), (wall, parapet, roof) = half, surfaces
    add_box(builder, frame, (-a, -b, -1.5), (a, b, height - 0.01), wall)
    corners = np.array([(-a, -b, height), (a, -b, height), (a, b, height), (-a, b, height)])
    builder.quad(frame.place(corners), roof)
    for low, high in (
        ((-a, -b), (a, -b + 0.3)),
        ((-a, b - 0.3), (a, b)),
        ((-a, -b), (-a + 0.3, b)),
        ((a - 0.3, -b), (a, b)),
    ):
        add_box(builder, frame, (*low, height), (*high, height + 0.35), parapet)


def _add_windows(
    builder: MeshBuilder, frame: Frame, half: tuple[float, float], storeys: int, style: Style
) -> None:
    for turn in range(4):
        wall = frame.at(0.0, 0.0, 0.0, turn * math.pi / 2)
        distance, width = (half[0], half[1]) if turn % 2 == 0 else (half[1], half[0])
        count = max(int(2 * width / 3.1), 1)
        for storey in range(storeys):
            for number in range(count):
                y = (number + 0.5) / count * 2 * width - width
                sill = 1.1 + 2.75 * storey
                door = storey == 0 and turn == 2 and number == 0
                low, high = (0.3, 2.4) if door else (sill, sill + 1.3)
                for grow, gap, surface in (
                    (0.12, 0.03, style.trim),
                    (0.0, 0.05, style.door if door else style.glass),
                ):
                    x, w = distance + gap, 0.62 + grow
                    points = np.array(
                        [
                            (x, y - w, low - grow),
                            (x, y + w, low - grow),
                            (x, y + w, high + grow),
                            (x, y - w, high + grow),
                        ]
                    )
                    builder.quad(wall.place(points), surface)


def _add_garage(
    builder: MeshBuilder, rng: np.random.Generator, frame: Frame, width: float, style: Style
) -> None:
    half = (3.1, width / 2)
    if rng.random() < 0.35:
        add_flat_roof(builder, frame, half, 2.7, (style.wall, style.trim, style.flat))
    else:
        turned = frame.at(0.0, 0.0, 0.0, math.pi / 2)
        body = Body((half[1], half[0]), 2.6, (half[1] + 0.45) * rng.uniform(0.4, 0.7), 0.0)
        _add_body(builder, turned, body, style)
    x, w = -half[0] - 0.04, half[1] - 0.45
    points = np.array([(x, -w, 0.05), (x, w, 0.05), (x, w, 2.25), (x, -w, 2.25)])
    builder.quad(frame.place(points), style.trim)


def _add_on_roof(
    builder: MeshBuilder, rng: np.random.Generator, frame: Frame, roof: Body, style: Style
) -> None:
    """Chimneys, vents, roof windows and solar panels."""
    brick = builder.surface(Material.BRICK, varied(rng, (0.24, 0.13, 0.10), 0.2))
    reach = roof.half[1] - roof.hip
    (a, _), ridge = roof.half, roof.eaves + roof.rise
    if rng.random() < 0.75:
        top = frame.at(rng.uniform(-0.25, 0.25) * a, rng.uniform(-0.8, 0.8) * reach)
        add_box(builder, top, (-0.4, -0.5, roof.eaves), (0.4, 0.5, ridge + 0.75), brick)
        dark = builder.surface(Material.PLAIN, (0.05, 0.05, 0.05))
        add_box(builder, top, (-0.22, -0.3, ridge), (0.22, 0.3, ridge + 0.95), dark)
    slopes = math.atan2(roof.rise, a)
    for _ in range(int(rng.integers(0, 4))):
        side, level = rng.choice([-1.0, 1.0]), rng.uniform(0.25, 0.75)
        spot = frame.at(side * a * (1 - level), rng.uniform(-0.9, 0.9) * reach)
        add_box(
            builder,
            spot,
            (-0.15, -0.15, roof.eaves),
            (0.15, 0.15, roof.eaves + level * roof.rise + 0.45),
            style.trim,
        )
    side = float(rng.choice([-1.0, 1.0]))
    for _ in range(int(rng.integers(0, 3))):
        y = rng.uniform(-0.8, 0.8) * reach
        _add_patch(
            builder,
            frame,
            roof,
            (-side, slopes),
            (y, y + 0.9),
            (0.45, 0.7),
            (style.glass, style.trim),
        )
    if rng.random() < 0.27 and reach > 2.5:
        solar = builder.surface(Material.SOLAR, (0.022, 0.028, 0.055))
        _add_patch(
            builder,
            frame,
            roof,
            (side, slopes),
            (-0.7 * reach, 0.6 * reach),
            (0.22, 0.85),
            (solar, style.trim),
        )


def _add_patch(
    builder: MeshBuilder,
    frame: Frame,
    roof: Body,
    place: tuple[float, float],
    along: tuple[float, float],
    up: tuple[float, float],
    surfaces: tuple[int, int],
) -> None:
    """Add a flat rectangle on a slope of a roof, 10 cm above it, with a frame."""
    side, slope = place
    for grow, lift, surface in ((0.09, 0.05, surfaces[1]), (0.0, 0.1, surfaces[0])):
        points = []
        for y, level in (
            (along[0] - grow, up[0]),
            (along[1] + grow, up[0]),
            (along[1] + grow, up[1]),
            (along[0] - grow, up[1]),
        ):
            part = level + (grow if level == up[1] else -grow) / max(roof.half[0], 1.0)
            x = side * roof.half[0] * (1 - part) + side * lift * math.sin(slope)
            points.append((x, y, roof.eaves + part * roof.rise + lift * math.cos(slope)))
        builder.quad(frame.place(np.array(points)), surface)
