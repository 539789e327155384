from __future__ import annotations

import pytest

from aerocues.simulation.lighting import Weather
from aerocues.simulation.rendering import Stage
from aerocues.simulation.scene import Scene
from aerocues.simulation.scenes import build_scene, stage

HALF = 60.0


@pytest.fixture(scope="session")
def suburb() -> Scene:
    return build_scene("suburb", seed=3, half=HALF)


@pytest.fixture(scope="session")
def suburb_stage(suburb: Scene) -> Stage:
    return stage(suburb, Weather())
