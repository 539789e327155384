"""One small scene and its models, which tests read."""

from __future__ import annotations

from pathlib import Path

import pytest

import aerocues
from aerocues.datasets.dataset import Dataset
from aerocues.reconstruction.models import Models
from tests.reconstruction.scenes import Options, write_scene

OPTIONS: Options = {"max_keypoints": 1000, "baseline": False}
COMBINATIONS = "SIFT-SIFT-L2-FLANN,ORB-ORB-HAM-BF"


@pytest.fixture(scope="session")
def landscape(tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    """Nine photographs with known poses and depth."""
    return write_scene(tmp_path_factory.mktemp("landscape") / "images")


@pytest.fixture(scope="session")
def models(landscape: Dataset, tmp_path_factory: pytest.TempPathFactory) -> Models:
    """Models of the landscape; tests change nothing in them."""
    output = tmp_path_factory.mktemp("models") / "models"
    return aerocues.reconstruct(landscape, COMBINATIONS, output, workers=1, **OPTIONS)


@pytest.fixture
def quick() -> Options:
    """Options under which a small scene takes seconds."""
    return OPTIONS


@pytest.fixture
def empty(tmp_path: Path) -> Path:
    """Where models may go."""
    return tmp_path / "models"
