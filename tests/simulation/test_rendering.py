from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from aerocues.datasets.dataset import PinholeCamera
from aerocues.simulation.camera import Pose, pinhole
from aerocues.simulation.covers import ground_colour
from aerocues.simulation.lighting import Weather
from aerocues.simulation.mesh import Mesh, MeshBuilder
from aerocues.simulation.rasterizer import boxes_of, visible
from aerocues.simulation.rendering import Stage, render
from aerocues.simulation.scene import Scene
from aerocues.simulation.scenes import build_scene, stage
from aerocues.simulation.sensor import Sensor, develop
from aerocues.simulation.surfaces import Material

pytestmark = pytest.mark.slow

CAMERA = pinhole(150, 100, 90.0)
POSES = (Pose(0, 0, -60, -90, 0), Pose(-10, 5, -45, -60, 30), Pose(5, 0, -30, -25, 200, 10))


def rays(camera: PinholeCamera, pose: Pose, at: NDArray[np.int64]) -> NDArray[np.float64]:
    """Directions in the world of pixels (column, row), of depth 1."""
    x = (at[:, 0] - camera.centre_x) / camera.focal_x
    y = (at[:, 1] - camera.centre_y) / camera.focal_y
    return np.asarray(np.column_stack([x, y, np.ones(len(x))]) @ pose.rotation)


def cast(mesh: Mesh, origin: NDArray[np.float64], directions: NDArray[np.float64]) -> list[float]:
    """The nearest of all triangles by Möller and Trumbore's test, with nothing in common."""
    a, b, c = (mesh.vertices[mesh.triangles[:, i]].astype(np.float64) for i in range(3))
    first, second, offset = b - a, c - a, origin - a
    # Triple products, ordered so that a ray takes only products of a matrix and itself.
    normals, q = np.cross(second, first), np.cross(offset, first)
    p, height = np.cross(second, offset), (second * q).sum(axis=1)
    found = []
    for ray in directions:
        determinant = normals @ ray
        with np.errstate(divide="ignore", invalid="ignore"):
            u, v, t = p @ ray / determinant, q @ ray / determinant, height / determinant
        hit = (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0.2) & (np.abs(determinant) > 1e-15)
        found.append(float(t[hit].min(initial=np.inf)))
    return found


@pytest.mark.parametrize("pose", POSES)
def test_depth_is_what_a_ray_caster_finds(suburb_stage: Stage, pose: Pose) -> None:
    depth = render(suburb_stage, CAMERA, pose).depth
    generator = np.random.default_rng(4)
    at = np.column_stack([generator.integers(0, 150, 40), generator.integers(0, 100, 40)])
    found = cast(suburb_stage.mesh, pose.centre, rays(CAMERA, pose, at))
    measured = depth[at[:, 1], at[:, 0]]
    off = ~np.isclose(measured, found, rtol=0, atol=1e-3)
    # A ray through the very edge of a triangle may be decided either way.
    assert off.sum() <= 1, (measured[off], np.array(found)[off])


def test_a_known_vertex_is_seen_at_its_pixel() -> None:
    builder = MeshBuilder()
    # A plate 10 m below whose edges fall on the borders of pixels 40..59 and 30..49.
    camera, pose = pinhole(100, 80, 90.0), Pose(0, 0, 0, -90, 0)
    north, east = (40 - np.array([30, 50])) / 5.0, (np.array([40, 60]) - 50) / 5.0
    corners = [
        (n, e, -10.0)
        for n, e in (
            (north[0], east[0]),
            (north[0], east[1]),
            (north[1], east[1]),
            (north[1], east[0]),
        )
    ]
    builder.quad(np.array(corners), builder.surface(Material.PLAIN, (0.5, 0.5, 0.5)))
    mesh = builder.build()
    ids = visible(mesh, boxes_of(mesh), camera, pose.rotation, pose.centre)
    rows, columns = np.nonzero(ids >= 0)
    assert (columns.min(), columns.max(), rows.min(), rows.max()) == (40, 59, 30, 49)


def test_what_reaches_behind_the_camera_is_cut(suburb_stage: Stage) -> None:
    depth = render(suburb_stage, CAMERA, Pose(0, 0, -20, 0, 45)).depth
    assert np.isinf(depth[0]).all()  # sky
    assert np.isfinite(depth[-1]).all()
    assert depth.min() > 0.2


def test_the_same_seed_gives_the_same_bytes() -> None:
    def picture() -> tuple[bytes, bytes]:
        scene = build_scene("suburb", seed=9, half=40.0)
        rendering = render(stage(scene, Weather()), CAMERA, POSES[0])
        pixels = develop(rendering.radiance, Sensor(), np.random.default_rng(1))
        return pixels.tobytes(), rendering.depth.tobytes()

    assert picture() == picture()


def test_a_point_of_the_ground_looks_the_same_from_everywhere(suburb: Scene) -> None:
    generator = np.random.default_rng(2)
    for north, east in generator.uniform(-50, 50, (50, 2)):
        small = 0.05
        first = ground_colour(suburb.plan, north, east, (0, small, 0), (-small, 0, 0), small)
        turned = ground_colour(suburb.plan, north, east, (small, 0, 0), (0, small, 0), small)
        assert turned == pytest.approx(first, rel=0.35, abs=0.02)


def test_views_of_one_place_agree(suburb_stage: Stage) -> None:
    """Radiance at pixels of one view, looked up in another: correlated, without bias."""
    camera = pinhole(300, 200, 90.0)
    first, second = Pose(0, 0, -50, -90, 0), Pose(6, 8, -54, -80, 40)
    one, two = render(suburb_stage, camera, first), render(suburb_stage, camera, second)
    rows, columns = np.mgrid[40:160:3, 60:240:3].reshape(2, -1)
    at = np.column_stack([columns, rows])
    points = first.centre + rays(camera, first, at) * one.depth[rows, columns, None]
    seen = (points - second.centre) @ second.rotation.T
    x = seen[:, 0] / seen[:, 2] * camera.focal_x + camera.centre_x
    y = seen[:, 1] / seen[:, 2] * camera.focal_y + camera.centre_y
    i, j = np.rint(y).astype(int), np.rint(x).astype(int)
    inside = (i >= 0) & (j >= 0) & (i < 200) & (j < 300)
    i, j, seen, rows, columns = (part[inside] for part in (i, j, seen, rows, columns))
    same = np.abs(two.depth[i, j] - seen[:, 2]) < 0.1
    assert same.mean() > 0.6
    a = one.radiance[rows[same], columns[same]].mean(axis=1)
    b = two.radiance[i[same], j[same]].mean(axis=1)
    assert np.corrcoef(a, b)[0, 1] > 0.8
    assert b.mean() == pytest.approx(a.mean(), rel=0.03)
