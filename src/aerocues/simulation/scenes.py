"""The kinds of scene: one row each, and their preparation for rendering."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from aerocues.errors import SimulationError
from aerocues.simulation.fields import build_fields
from aerocues.simulation.industrial import build_industrial
from aerocues.simulation.lighting import Weather, bake, ground_centres
from aerocues.simulation.rendering import Stage
from aerocues.simulation.scene import Scene
from aerocues.simulation.suburb import build_suburb

HALF = 380.0
"""Default extent of details from the origin in metres: as far as oblique cameras at 140 m see."""


@dataclass(frozen=True)
class SceneKind:
    """One row: name, description, and a function of the seed and the extent."""

    name: str
    description: str
    build: Callable[[int, float], Scene]


SCENES: tuple[SceneKind, ...] = (
    SceneKind("suburb", "houses, gardens, trees, cars, streets, parks: rich", build_suburb),
    SceneKind("fields", "rows of crops, stubble, hedgerows, a farm: repetitive", build_fields),
    SceneKind("industrial", "halls, yards, containers, car parks: plain", build_industrial),
)
_KINDS = {kind.name: kind for kind in SCENES}


def build_scene(name: str, seed: int = 0, half: float = HALF) -> Scene:
    """Build a scene; the same name, seed and extent give the same scene.

    Parameters
    ----------
    name : str
        Name of a row of `SCENES`.
    seed : int
    half : float
        Extent of the details from the origin to each side in metres; outside is simple ground.

    Raises
    ------
    SimulationError
        If there is no such scene.
    """
    require_scene(name)
    return _KINDS[name].build(seed, half)


def require_scene(name: str) -> None:
    """Raise SimulationError if there is no scene of this name."""
    if name not in _KINDS:
        raise SimulationError(f"there is no scene '{name}'; use {', '.join(_KINDS)}")


def stage(scene: Scene, weather: Weather, time: float = 0.0, wind: float = 0.0) -> Stage:
    """Bake the light of a scene after `time` seconds, in a wind."""
    centres = ground_centres(scene.half)
    heights = scene.terrain.height(centres.reshape(-1, 2)).reshape(centres.shape[:2])
    mesh = scene.at(time, wind)
    light = bake(mesh, np.asarray(heights, np.float32), scene.half, weather)
    return Stage.of(mesh, scene.plan, light)
