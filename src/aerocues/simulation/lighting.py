"""Light of a scene, baked before the first frame: sun shadows and visible sky."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from aerocues.compiled import compiled
from aerocues.simulation.mesh import Mesh
from aerocues.simulation.rasterizer import nearest
from aerocues.simulation.surfaces import Rgb

# Side of the shadow map: larger maps have sharper shadow edges and take more memory and baking time
# (100 MB; texels of 0.2 m in a scene of 380 m).
_SHADOW_SIZE = 5120
# The visible sky is computed on cells of this side in metres, in this many directions and at these
# distances in cells. They grow like Fibonacci numbers: near objects hide more of the sky than far
# ones. More of each is more exact, and baking takes longer.
_SKY_CELL = 0.5
_SKY_DIRECTIONS = 12
_SKY_STEPS = (1, 2, 3, 5, 8, 13, 21, 34)
_POROSITY = 0.75
"""Share of the sky that higher objects hide: crowns let some light through."""


@dataclass(frozen=True)
class Weather:
    """Sun and air.

    Parameters
    ----------
    azimuth, elevation : float
        Direction of the sun: degrees clockwise from north, and above the horizon.
    haze : float
        0: none; 1 halves the contrast at about 700 m.
    glints : float
        Dependence of the appearance on the viewing direction, relative to dry vegetation: leaves
        and blades of grass shine in one direction, tiles a little. 0: none.
    """

    azimuth: float = 140.0
    elevation: float = 48.0
    haze: float = 0.2
    glints: float = 1.0


class Light(NamedTuple):
    """Baked light.

    Parameters
    ----------
    sun : (3,) float64
        Unit vector to the sun: north, east, up.
    sun_colour, sky_colour : (3,) float64
        Irradiance / pi: the radiance of a white surface that faces the light.
    shadow : (S, S) float32
        Nearness to the sun, in metres, of the first surface that it meets.
    shadow_frame : (3, 4) float64
        From the world (north, east, down) to column, row and nearness of `shadow`.
    openness : (K, K) float32
        Share of the sky visible from the ground, in cells from `-half`.
    top, floor : (K, K) float32
        Height in metres of the highest surface and of the ground in each cell.
    half : float
    extinction : float
        Extinction of the air per metre.
    glints : float
        See `Weather`.
    """

    sun: NDArray[np.float64]
    sun_colour: NDArray[np.float64]
    sky_colour: NDArray[np.float64]
    shadow: NDArray[np.float32]
    shadow_frame: NDArray[np.float64]
    openness: NDArray[np.float32]
    top: NDArray[np.float32]
    floor: NDArray[np.float32]
    half: float
    extinction: float
    glints: float


def bake(mesh: Mesh, floor: NDArray[np.float32], half: float, weather: Weather) -> Light:
    """Light of a mesh whose details are within `half` metres of the origin.

    Parameters
    ----------
    mesh : Mesh
    floor : (K, K) float32
        Height of the ground at the centres of 0.5 m cells, rows north and columns east.
    half : float
    weather : Weather
    """
    azimuth, elevation = math.radians(weather.azimuth), math.radians(weather.elevation)
    level = math.cos(elevation)
    sun = np.array([level * math.cos(azimuth), level * math.sin(azimuth), math.sin(elevation)])
    frame = _shadow_frame(sun, half)
    top = np.maximum(nearest(mesh, _frame_from_above(half), floor.shape), floor)
    # A lower sun has a longer path through the air, which scatters blue light.
    path = min(1.0 / max(sun[2], 0.05), 12.0)
    through = np.exp(-np.array([0.055, 0.095, 0.17]) * path * (1 + 0.6 * weather.haze))
    return Light(
        sun,
        3.0 * through,
        np.array([0.40, 0.50, 0.66]) * (1 + 0.35 * weather.haze),
        nearest(mesh, frame, (_SHADOW_SIZE, _SHADOW_SIZE)),
        frame,
        _openness(top, floor),
        top,
        floor,
        half,
        weather.haze * 0.001,
        weather.glints,
    )


def ground_centres(half: float) -> NDArray[np.float64]:
    """North and east of the cell centres at which `bake` needs the height of the ground."""
    count = round(2 * half / _SKY_CELL)
    centres = (np.arange(count) + 0.5) * _SKY_CELL - half
    north, east = np.meshgrid(centres, centres, indexing="ij")
    return np.stack([north, east], axis=-1)


def _frame_from_above(half: float) -> NDArray[np.float64]:
    scale, middle = 1 / _SKY_CELL, half / _SKY_CELL - 0.5
    return np.array([[0, scale, 0, middle], [scale, 0, 0, middle], [0, 0, -1.0, 0]])


def _shadow_frame(sun: NDArray[np.float64], half: float) -> NDArray[np.float64]:
    towards = np.array([sun[0], sun[1], -sun[2]])
    across = np.cross(towards, [0.0, 0.0, 1.0])
    across /= np.linalg.norm(across)
    scale = _SHADOW_SIZE / (2 * math.sqrt(2) * half)
    rows = np.cross(towards, across)
    frame = np.zeros((3, 4))
    frame[:, :3] = np.stack([across * scale, rows * scale, towards])
    # A low sun sees the ground foreshortened, so that its rows can use the whole map.
    frame[1] *= 1.0 / max(abs(sun[2]), 0.35)
    frame[:2, 3] = _SHADOW_SIZE / 2
    return frame


def _openness(top: NDArray[np.float32], floor: NDArray[np.float32]) -> NDArray[np.float32]:
    """Share of the sky above the horizon that the surroundings of each cell leave visible."""
    seen = np.zeros_like(top)
    for direction in range(_SKY_DIRECTIONS):
        angle = 2 * math.pi * (direction + 0.5) / _SKY_DIRECTIONS
        slope = np.zeros_like(top)
        for step in _SKY_STEPS:
            shift = round(step * math.cos(angle)), round(step * math.sin(angle))
            distance = max(math.hypot(*shift), 1.0) * _SKY_CELL
            higher = np.roll(top, shift, axis=(0, 1)) - floor
            np.maximum(slope, higher / distance, out=slope)
        # In a uniform sky, the part below elevation e contributes sin(e)^2 of the light.
        seen += 1 - _POROSITY * slope**2 / (1 + slope**2)
    return np.asarray(seen / _SKY_DIRECTIONS, np.float32)


@compiled
def sunlit(light: Light, at: Rgb, normal: Rgb) -> float:
    """Share of the sun that reaches a point (north, east, up): 0 to 1, with soft edges."""
    frame, size = light.shadow_frame, len(light.shadow)
    # Offset from the surface: a texel of the map must not shade its own surface.
    x, y, z = at[0] + 0.12 * normal[0], at[1] + 0.12 * normal[1], -at[2] - 0.12 * normal[2]
    column = frame[0, 0] * x + frame[0, 1] * y + frame[0, 2] * z + frame[0, 3]
    row = frame[1, 0] * x + frame[1, 1] * y + frame[1, 2] * z + frame[1, 3]
    near = frame[2, 0] * x + frame[2, 1] * y + frame[2, 2] * z + 0.12
    first_column, first_row = math.floor(column - 0.5), math.floor(row - 0.5)
    if min(first_column, first_row) < 0 or max(first_column, first_row) > size - 3:
        return 1.0
    u, v = column - 0.5 - first_column, row - 0.5 - first_row
    lit = 0.0
    for i in range(3):
        weight = (1.0 - v if i == 0 else 1.0 if i == 1 else v) * 0.5
        for j in range(3):
            share = (1.0 - u if j == 0 else 1.0 if j == 1 else u) * 0.5
            if light.shadow[first_row + i, first_column + j] <= near:
                lit += weight * share
    return lit


@compiled
def sky_seen(light: Light, at: Rgb) -> float:
    """Share of the sky visible from a point: baked on the ground, 1 at the highest surface."""
    size = len(light.openness)
    row = (at[0] + light.half) / _SKY_CELL - 0.5
    column = (at[1] + light.half) / _SKY_CELL - 0.5
    i, j = math.floor(row), math.floor(column)
    if i < 0 or j < 0 or i > size - 2 or j > size - 2:
        return 1.0
    u, v = row - i, column - j
    seen = 0.0
    for di in range(2):
        for dj in range(2):
            weight = (u if di else 1.0 - u) * (v if dj else 1.0 - v)
            ground, top = light.floor[i + di, j + dj], light.top[i + di, j + dj]
            rise = min(max((at[2] - ground) / max(top - ground, 0.5), 0.0), 1.0)
            open_below = light.openness[i + di, j + dj]
            seen += weight * (open_below + (1.0 - open_below) * rise)
    return seen
