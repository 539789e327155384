"""A z-buffer for central and parallel projection: the visible triangle at each sample."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from aerocues.compiled import compiled
from aerocues.datasets.dataset import PinholeCamera
from aerocues.simulation.mesh import Mesh

NEAR = 0.2
"""Near plane in metres along the axis; closer surfaces are clipped."""

NOTHING = -1
Corner = tuple[float, float, float]


@compiled
def _fill(
    a: Corner,
    b: Corner,
    c: Corner,
    identity: int,
    nearness: NDArray[np.float32],
    ids: NDArray[np.int32],
) -> None:
    """Draw a triangle; corners are column, row and nearness, which is linear in both."""
    height, width = nearness.shape
    first_x = max(math.ceil(min(a[0], b[0], c[0])), 0)
    last_x = min(math.floor(max(a[0], b[0], c[0])), width - 1)
    first_y = max(math.ceil(min(a[1], b[1], c[1])), 0)
    last_y = min(math.floor(max(a[1], b[1], c[1])), height - 1)
    if first_x > last_x or first_y > last_y:
        return
    area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    if abs(area) < 1e-12:
        return
    scale = 1.0 / area
    # Barycentric weights of b and c are linear in column and row.
    b_x, b_y = (c[1] - a[1]) * scale, (a[0] - c[0]) * scale
    c_x, c_y = (a[1] - b[1]) * scale, (b[0] - a[0]) * scale
    b_row = (first_x - a[0]) * b_x + (first_y - a[1]) * b_y
    c_row = (first_x - a[0]) * c_x + (first_y - a[1]) * c_y
    b_rise, c_rise = b[2] - a[2], c[2] - a[2]
    for y in range(first_y, last_y + 1):
        weight_b, weight_c = b_row, c_row
        for x in range(first_x, last_x + 1):
            if weight_b >= 0.0 and weight_c >= 0.0 and weight_b + weight_c <= 1.0:
                near = np.float32(a[2] + weight_b * b_rise + weight_c * c_rise)
                if near > nearness[y, x]:
                    nearness[y, x] = near
                    ids[y, x] = identity
            weight_b += b_x
            weight_c += c_x
        b_row += b_y
        c_row += c_y


@compiled
def _cut(inside: Corner, outside: Corner) -> Corner:
    """The intersection of an edge in camera coordinates with the near plane."""
    part = (NEAR - inside[2]) / (outside[2] - inside[2])
    return (
        inside[0] + part * (outside[0] - inside[0]),
        inside[1] + part * (outside[1] - inside[1]),
        NEAR,
    )


@compiled
def _draw_clipped(
    a: Corner,
    b: Corner,
    c: Corner,
    identity: int,
    lens: tuple[float, float, float, float],
    nearness: NDArray[np.float32],
    ids: NDArray[np.int32],
) -> None:
    """Project a triangle in camera coordinates, clipped at the near plane."""
    count = int(a[2] >= NEAR) + int(b[2] >= NEAR) + int(c[2] >= NEAR)
    if count == 0:
        return
    d = c
    if count == 1:
        while a[2] < NEAR:
            a, b, c = b, c, a
        b, c = _cut(a, b), _cut(a, c)
    elif count == 2:
        while c[2] >= NEAR:
            a, b, c = b, c, a
        c, d = _cut(b, c), _cut(a, c)
    fx, fy, cx, cy = lens
    first = (fx * a[0] / a[2] + cx, fy * a[1] / a[2] + cy, 1.0 / a[2])
    third = (fx * c[0] / c[2] + cx, fy * c[1] / c[2] + cy, 1.0 / c[2])
    second = (fx * b[0] / b[2] + cx, fy * b[1] / b[2] + cy, 1.0 / b[2])
    _fill(first, second, third, identity, nearness, ids)
    if count == 2:
        fourth = (fx * d[0] / d[2] + cx, fy * d[1] / d[2] + cy, 1.0 / d[2])
        _fill(first, third, fourth, identity, nearness, ids)


@compiled
def _turned(
    vertices: NDArray[np.float32],
    rotation: NDArray[np.float64],
    centre: NDArray[np.float64],
    first: int,
    stop: int,
    moved: NDArray[np.float64],
) -> None:
    for vertex in range(first, stop):
        x = vertices[vertex, 0] - centre[0]
        y = vertices[vertex, 1] - centre[1]
        z = vertices[vertex, 2] - centre[2]
        for axis in range(3):
            moved[vertex - first, axis] = (
                rotation[axis, 0] * x + rotation[axis, 1] * y + rotation[axis, 2] * z
            )


@compiled
def _outside(
    box: NDArray[np.float32],
    rotation: NDArray[np.float64],
    centre: NDArray[np.float64],
    slopes: tuple[float, float, float, float],
) -> bool:
    """Whether a box is completely outside one side of the viewing pyramid."""
    left = right = above = below = behind = 0
    for corner in range(8):
        x = box[corner & 1, 0] - centre[0]
        y = box[(corner >> 1) & 1, 1] - centre[1]
        z = box[(corner >> 2) & 1, 2] - centre[2]
        across = rotation[0, 0] * x + rotation[0, 1] * y + rotation[0, 2] * z
        down = rotation[1, 0] * x + rotation[1, 1] * y + rotation[1, 2] * z
        ahead = rotation[2, 0] * x + rotation[2, 1] * y + rotation[2, 2] * z
        left += across < slopes[0] * ahead
        right += across > slopes[1] * ahead
        above += down < slopes[2] * ahead
        below += down > slopes[3] * ahead
        behind += ahead < NEAR
    return max(left, right, above, below, behind) == 8


@compiled
def _draw_central(
    vertices: NDArray[np.float32],
    triangles: NDArray[np.int32],
    objects: NDArray[np.int32],
    corners: NDArray[np.int32],
    boxes: NDArray[np.float32],
    rotation: NDArray[np.float64],
    centre: NDArray[np.float64],
    lens: tuple[float, float, float, float],
    nearness: NDArray[np.float32],
    ids: NDArray[np.int32],
) -> None:
    height, width = nearness.shape
    fx, fy, cx, cy = lens
    slopes = ((-0.5 - cx) / fx, (width - 0.5 - cx) / fx, (-0.5 - cy) / fy, (height - 0.5 - cy) / fy)
    moved = np.empty((1, 3))
    for member in range(len(objects)):
        if _outside(boxes[member], rotation, centre, slopes):
            continue
        first, stop = corners[member]
        if stop - first > len(moved):
            moved = np.empty((stop - first, 3))
        _turned(vertices, rotation, centre, first, stop, moved)
        for triangle in range(objects[member, 0], objects[member, 1]):
            i, j, k = triangles[triangle]
            a = (moved[i - first, 0], moved[i - first, 1], moved[i - first, 2])
            b = (moved[j - first, 0], moved[j - first, 1], moved[j - first, 2])
            c = (moved[k - first, 0], moved[k - first, 1], moved[k - first, 2])
            _draw_clipped(a, b, c, triangle, lens, nearness, ids)


@compiled
def _draw_parallel(
    vertices: NDArray[np.float32],
    triangles: NDArray[np.int32],
    frame: NDArray[np.float64],
    nearness: NDArray[np.float32],
    ids: NDArray[np.int32],
) -> None:
    corners = np.empty((3, 3))
    for triangle in range(len(triangles)):
        for corner in range(3):
            x, y, z = vertices[triangles[triangle, corner]]
            for axis in range(3):
                corners[corner, axis] = (
                    frame[axis, 0] * x + frame[axis, 1] * y + frame[axis, 2] * z + frame[axis, 3]
                )
        a = (corners[0, 0], corners[0, 1], corners[0, 2])
        b = (corners[1, 0], corners[1, 1], corners[1, 2])
        c = (corners[2, 0], corners[2, 1], corners[2, 2])
        _fill(a, b, c, triangle, nearness, ids)


def boxes_of(mesh: Mesh) -> NDArray[np.float32]:
    """Minimum and maximum coordinates of each object, (O, 2, 3) float32."""
    starts = mesh.corners[:, 0]
    return np.stack(
        [np.minimum.reduceat(mesh.vertices, starts), np.maximum.reduceat(mesh.vertices, starts)], 1
    )


def visible(
    mesh: Mesh,
    boxes: NDArray[np.float32],
    camera: PinholeCamera,
    rotation: NDArray[np.float64],
    centre: NDArray[np.float64],
) -> NDArray[np.int32]:
    """The visible triangle at the centre of each pixel, (H, W) int32; -1 if there is none.

    Parameters
    ----------
    mesh : Mesh
    boxes : (O, 2, 3) float32
        See `boxes_of`.
    camera : PinholeCamera
    rotation, centre : (3, 3) and (3,) float64
        Rotation from the world to the camera, and position of the camera.
    """
    ids = np.full((camera.height, camera.width), NOTHING, np.int32)
    lens = (camera.focal_x, camera.focal_y, camera.centre_x, camera.centre_y)
    _draw_central(
        mesh.vertices,
        mesh.triangles,
        mesh.objects,
        mesh.corners,
        boxes,
        rotation,
        centre,
        lens,
        np.zeros(ids.shape, np.float32),
        ids,
    )
    return ids


def nearest(mesh: Mesh, frame: NDArray[np.float64], shape: tuple[int, int]) -> NDArray[np.float32]:
    """Nearness of the first surface on parallel rays, (H, W) float32; -inf if there is none.

    Parameters
    ----------
    mesh : Mesh
    frame : (3, 4) float64
        From the world (homogeneous) to column, row and nearness.
    shape : tuple of int
        Height and width of the grid.
    """
    found = np.full(shape, -np.inf, np.float32)
    _draw_parallel(mesh.vertices, mesh.triangles, frame, found, np.empty(shape, np.int32))
    return found
