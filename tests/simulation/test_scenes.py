from __future__ import annotations

import numpy as np
import pytest

from aerocues.errors import SimulationError
from aerocues.simulation.camera import Pose, pinhole
from aerocues.simulation.ground import Cover
from aerocues.simulation.lighting import Weather
from aerocues.simulation.rendering import Stage, render
from aerocues.simulation.scene import Scene
from aerocues.simulation.scenes import SCENES, build_scene, stage
from aerocues.simulation.sensor import Sensor, develop

pytestmark = pytest.mark.slow

CAMERA = pinhole(150, 100, 90.0)
POSE = Pose(0, 0, -50, -90, 0)


@pytest.mark.parametrize("name", [kind.name for kind in SCENES])
@pytest.mark.parametrize("half", [40.0, 50.0, 90.0])
def test_every_scene_is_whole_at_every_size(name: str, half: float) -> None:
    mesh = build_scene(name, 5, half).mesh
    assert np.isfinite(mesh.vertices).all()
    assert mesh.triangles.min() >= 0
    assert mesh.triangles.max() < len(mesh.vertices)
    assert mesh.objects[-1, 1] == len(mesh.triangles)
    assert len(mesh.surface) == len(mesh.triangles)
    for (first, stop), (low, high) in zip(mesh.objects, mesh.corners, strict=True):
        own = mesh.triangles[first:stop]
        assert own.min() >= low
        assert own.max() < high


def test_an_unknown_scene_names_the_known() -> None:
    with pytest.raises(SimulationError, match="suburb"):
        build_scene("moon")


def test_seeds_give_different_scenes(suburb: Scene) -> None:
    other = build_scene("suburb", seed=4, half=60.0)
    assert other.mesh.vertices.shape != suburb.mesh.vertices.shape


def test_the_ground_has_what_a_suburb_has(suburb: Scene) -> None:
    found = set(np.unique(suburb.plan.cover).tolist())
    assert {Cover.LAWN, Cover.ASPHALT, Cover.PAVEMENT, Cover.MARKING, Cover.SOIL} <= found


def test_nothing_floats(suburb: Scene) -> None:
    """Each object reaches into the ground or stands on it."""
    mesh = suburb.mesh
    for first, stop in mesh.corners:
        own = mesh.vertices[first:stop].astype(np.float64)
        if np.abs(own[:, :2]).max() > 60.0:
            continue
        above = -own[:, 2] - suburb.terrain.height(own[:, :2])
        assert above.min() < 0.35


def test_time_moves_cars_and_wind_moves_leaves(suburb: Scene) -> None:
    still, later = suburb.at(0.0), suburb.at(2.0)
    moved = np.flatnonzero(np.abs(later.vertices - still.vertices).max(axis=1) > 1e-4)
    cars = {v for r in suburb.routes for v in range(*suburb.mesh.corners[r.member])}
    assert set(moved.tolist()) <= cars
    assert len(suburb.routes) == 0 or len(moved) > 0
    blown = suburb.at(0.0, wind=0.2)
    shift = np.abs(blown.vertices - still.vertices).max(axis=1)
    assert 0.02 < shift.max() < 0.6
    leafy = np.unique(suburb.mesh.triangles[suburb.leafy])
    assert set(np.flatnonzero(shift).tolist()) <= set(leafy.tolist())


def test_glints_change_from_view_to_view_and_leave_the_depth(
    suburb: Scene, suburb_stage: Stage
) -> None:
    dull = stage(suburb, Weather(glints=0.0))
    views = [POSE, Pose(12, 0, -50, -90, 0)]
    with_glints, without = (
        [render(s, CAMERA, pose) for pose in views] for s in (suburb_stage, dull)
    )
    # How much brighter glints make each spot of the ground, as the one and the other camera see it.
    first, second = (
        np.log(a.radiance.mean(axis=2) / b.radiance.mean(axis=2))
        for a, b in zip(with_glints, without, strict=True)
    )
    shift = round(12 / 50 * CAMERA.focal_y)
    own = float(np.corrcoef(first[:-shift].ravel(), second[shift:].ravel())[0, 1])
    assert 0.02 < first.std() < 0.2
    assert abs(own) < 0.2
    for a, b in zip(with_glints, without, strict=True):
        np.testing.assert_array_equal(a.depth, b.depth)


def test_the_sun_moves_shadows_and_haze_lowers_contrast(suburb: Scene, suburb_stage: Stage) -> None:
    plain = render(suburb_stage, CAMERA, POSE)
    evening = render(stage(suburb, Weather(azimuth=270, elevation=20)), CAMERA, POSE)
    hazy = render(stage(suburb, Weather(haze=6.0)), CAMERA, POSE)
    assert np.array_equal(plain.depth, evening.depth)
    assert evening.radiance.mean() < 0.8 * plain.radiance.mean()
    assert hazy.radiance.std() < 0.9 * plain.radiance.std()


def test_each_nuisance_of_the_sensor_alone(suburb_stage: Stage) -> None:
    radiance = render(suburb_stage, CAMERA, POSE).radiance
    ideal = Sensor(noise=0, blur=0, vignetting=0)

    def taken(sensor: Sensor, seed: int = 1) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
        return develop(radiance, sensor, np.random.default_rng(seed)).astype(np.float64)

    plain = taken(ideal)
    assert np.array_equal(plain, taken(ideal, seed=2))
    noisy = Sensor(noise=2, blur=0, vignetting=0)
    assert 0.5 < np.abs(taken(noisy) - plain).mean() < 12
    for blurred in (Sensor(0, 1.5, 0, 0), Sensor(0, 0, 4.0, 0)):
        assert np.diff(taken(blurred), axis=0).std() < 0.8 * np.diff(plain, axis=0).std()
    dark = taken(Sensor(0, 0, 0, 0.5))
    assert dark[0, 0].mean() < 0.9 * plain[0, 0].mean() + 1
    means = [taken(Sensor(0, 0, 0, 0, 0.3), seed).mean() for seed in range(6)]
    assert np.std(means) > 3
