"""Renders linear colour and exact depth of pixels from the visible triangles."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aerocues.compiled import compiled
from aerocues.datasets.dataset import PinholeCamera
from aerocues.simulation.appearance import glint, lit, sky, through_air
from aerocues.simulation.camera import Pose, enlarged
from aerocues.simulation.covers import ground_colour
from aerocues.simulation.ground import Plan
from aerocues.simulation.lighting import Light
from aerocues.simulation.mesh import Mesh
from aerocues.simulation.rasterizer import boxes_of, visible
from aerocues.simulation.surfaces import Material, Rgb, object_colour, scaled

SAMPLES = 2
"""Visibility samples per side of a pixel: more make smoother edges, and the time of rasterisation
grows with the square."""

Lens = tuple[float, float, float, float]


@dataclass(frozen=True, eq=False)
class Rendering:
    """The image of an ideal camera.

    Parameters
    ----------
    radiance : (H, W, 3) float32
        Linear red, green, blue; about 2.5 for a white surface in full sun.
    depth : (H, W) float32
        Metres along the viewing axis at the centre of each pixel; infinite in the sky.
    """

    radiance: NDArray[np.float32]
    depth: NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class Stage:
    """Everything needed to render images of one moment.

    Parameters
    ----------
    mesh : Mesh
    boxes : (O, 2, 3) float32
        Bounding boxes of the objects of the mesh.
    plan : Plan
    light : Light
    """

    mesh: Mesh
    boxes: NDArray[np.float32]
    plan: Plan
    light: Light

    @classmethod
    def of(cls, mesh: Mesh, plan: Plan, light: Light) -> Stage:
        """The stage with the boxes of its mesh."""
        return cls(mesh, boxes_of(mesh), plan, light)


def render(stage: Stage, camera: PinholeCamera, pose: Pose) -> Rendering:
    """Render a view: 2 x 2 visibility samples per pixel, shading once per pixel and surface."""
    mesh, rotation, centre = stage.mesh, pose.rotation, pose.centre
    fine = enlarged(camera, SAMPLES)
    samples = visible(mesh, stage.boxes, fine, rotation, centre)
    centres = visible(mesh, stage.boxes, camera, rotation, centre)
    lens = (camera.focal_x, camera.focal_y, camera.centre_x, camera.centre_y)
    radiance = np.empty((*centres.shape, 3), np.float32)
    _shade(
        samples,
        mesh.vertices,
        mesh.triangles,
        mesh.surface,
        mesh.kinds,
        mesh.colours,
        stage.plan,
        stage.light,
        rotation,
        centre,
        lens,
        radiance,
    )
    depth = np.empty(centres.shape, np.float32)
    _measure(centres, mesh.vertices, mesh.triangles, rotation, centre, lens, depth)
    return Rendering(radiance, depth)


@compiled
def _ray(rotation: NDArray[np.float64], lens: Lens, column: float, row: float) -> Rgb:
    """Direction in the world (north, east, down) of a pixel; its depth along the axis is 1."""
    x, y = (column - lens[2]) / lens[0], (row - lens[3]) / lens[1]
    return (
        rotation[0, 0] * x + rotation[1, 0] * y + rotation[2, 0],
        rotation[0, 1] * x + rotation[1, 1] * y + rotation[2, 1],
        rotation[0, 2] * x + rotation[1, 2] * y + rotation[2, 2],
    )


@compiled
def _plane(
    vertices: NDArray[np.float32], triangles: NDArray[np.int32], triangle: int
) -> tuple[float, float, float, float]:
    """Unit normal (north, east, down), and its scalar product with a point of the plane."""
    i, j, k = triangles[triangle]
    ux = np.float64(vertices[j, 0]) - vertices[i, 0]
    uy = np.float64(vertices[j, 1]) - vertices[i, 1]
    uz = np.float64(vertices[j, 2]) - vertices[i, 2]
    vx = np.float64(vertices[k, 0]) - vertices[i, 0]
    vy = np.float64(vertices[k, 1]) - vertices[i, 1]
    vz = np.float64(vertices[k, 2]) - vertices[i, 2]
    x, y, z = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    length = max(math.sqrt(x * x + y * y + z * z), 1e-30)
    x, y, z = x / length, y / length, z / length
    return x, y, z, x * vertices[i, 0] + y * vertices[i, 1] + z * vertices[i, 2]


@compiled
def _reach(
    plane: tuple[float, float, float, float], centre: NDArray[np.float64], ray: Rgb
) -> float:
    """Depth at which a ray meets a plane."""
    along = plane[0] * ray[0] + plane[1] * ray[1] + plane[2] * ray[2]
    gap = plane[3] - (plane[0] * centre[0] + plane[1] * centre[1] + plane[2] * centre[2])
    return gap / along if abs(along) > 1e-12 else 0.0


@compiled
def _measure(
    centres: NDArray[np.int32],
    vertices: NDArray[np.float32],
    triangles: NDArray[np.int32],
    rotation: NDArray[np.float64],
    centre: NDArray[np.float64],
    lens: Lens,
    depth: NDArray[np.float32],
) -> None:
    height, width = centres.shape
    for row in range(height):
        for column in range(width):
            triangle = centres[row, column]
            if triangle < 0:
                depth[row, column] = np.inf
                continue
            plane = _plane(vertices, triangles, triangle)
            depth[row, column] = _reach(plane, centre, _ray(rotation, lens, column, row))


@compiled
def _seen(
    triangle: int,
    column: float,
    row: float,
    vertices: NDArray[np.float32],
    triangles: NDArray[np.int32],
    surface: NDArray[np.int32],
    kinds: NDArray[np.int32],
    colours: NDArray[np.float32],
    plan: Plan,
    light: Light,
    rotation: NDArray[np.float64],
    centre: NDArray[np.float64],
    lens: Lens,
) -> Rgb:
    """Radiance of a triangle at a position of the picture."""
    ray = _ray(rotation, lens, column, row)
    if triangle < 0:
        return sky(ray, light)
    plane = _plane(vertices, triangles, triangle)
    depth = _reach(plane, centre, ray)
    at = centre[0] + depth * ray[0], centre[1] + depth * ray[1], -(centre[2] + depth * ray[2])
    length = math.sqrt(ray[0] * ray[0] + ray[1] * ray[1] + ray[2] * ray[2])
    slant = (plane[0] * ray[0] + plane[1] * ray[1] + plane[2] * ray[2]) / length
    # The normal points to the side of the camera; up is the opposite of down.
    side = -1.0 if slant > 0 else 1.0
    normal = side * plane[0], side * plane[1], -side * plane[2]
    footprint = depth / lens[0] / math.sqrt(max(abs(slant), 0.05))
    row_of = surface[triangle]
    kind = kinds[row_of]
    if kind == Material.GROUND:
        beside, below = _ray(rotation, lens, column + 1, row), _ray(rotation, lens, column, row + 1)
        a, b = _reach(plane, centre, beside), _reach(plane, centre, below)
        right = centre[0] + a * beside[0] - at[0], centre[1] + a * beside[1] - at[1], 0.0
        down = centre[0] + b * below[0] - at[0], centre[1] + b * below[1] - at[1], 0.0
        colour = ground_colour(plan, at[0], at[1], right, down, footprint)
    else:
        base = float(colours[row_of, 0]), float(colours[row_of, 1]), float(colours[row_of, 2])
        colour = object_colour(kind, base, triangle, at, normal, footprint, 1000 + 40 * row_of)
    if light.glints > 0.0:
        colour = scaled(colour, 1.0 + light.glints * glint(kind, at, ray, length, footprint))
    return through_air(lit(kind, colour, at, normal, light), depth * length, light)


@compiled
def _shade(
    samples: NDArray[np.int32],
    vertices: NDArray[np.float32],
    triangles: NDArray[np.int32],
    surface: NDArray[np.int32],
    kinds: NDArray[np.int32],
    colours: NDArray[np.float32],
    plan: Plan,
    light: Light,
    rotation: NDArray[np.float64],
    centre: NDArray[np.float64],
    lens: Lens,
    radiance: NDArray[np.float32],
) -> None:
    """Shade each pixel once for each surface in it, at the centre of the surface's samples."""
    height, width = radiance.shape[:2]
    count = SAMPLES * SAMPLES
    for row in range(height):
        for column in range(width):
            red = green = blue = 0.0
            done = 0
            for sample in range(count):
                if (done >> sample) & 1:
                    continue
                triangle = samples[
                    row * SAMPLES + sample // SAMPLES, column * SAMPLES + sample % SAMPLES
                ]
                share, u, v = 0, 0.0, 0.0
                for other in range(sample, count):
                    i, j = other // SAMPLES, other % SAMPLES
                    if samples[row * SAMPLES + i, column * SAMPLES + j] == triangle:
                        done |= 1 << other
                        share += 1
                        u += (j + 0.5) / SAMPLES - 0.5
                        v += (i + 0.5) / SAMPLES - 0.5
                colour = _seen(
                    triangle,
                    column + u / share,
                    row + v / share,
                    vertices,
                    triangles,
                    surface,
                    kinds,
                    colours,
                    plan,
                    light,
                    rotation,
                    centre,
                    lens,
                )
                red += share * colour[0]
                green += share * colour[1]
                blue += share * colour[2]
            radiance[row, column, 0] = red / count
            radiance[row, column, 1] = green / count
            radiance[row, column, 2] = blue / count
