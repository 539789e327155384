"""One small scene and its models, which tests read."""

from __future__ import annotations

from pathlib import Path

import pytest

import aerocues
from aerocues.datasets.dataset import Dataset
from aerocues.reconstruction import engine
from aerocues.reconstruction.models import Models
from tests.made_once import made_once
from tests.reconstruction.scenes import Options, write_scene

OPTIONS: Options = {"max_keypoints": 600, "baseline": False}
COMBINATIONS = "SIFT-SIFT-L2-FLANN", "ORB-ORB-HAM-BF"


@pytest.fixture(scope="session")
def landscape(tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    """Six photographs with known poses and depth."""
    return made_once(tmp_path_factory, "landscape", write_scene)[1]


@pytest.fixture(scope="session")
def models(landscape: Dataset, tmp_path_factory: pytest.TempPathFactory) -> Models:
    """Models of the landscape, one made after the other; tests change nothing in them."""

    def make(folder: Path) -> None:
        for combination in COMBINATIONS:
            aerocues.reconstruct(landscape, combination, folder, workers=1, **OPTIONS)

    return Models(made_once(tmp_path_factory, "models", make)[0])


@pytest.fixture
def quick() -> Options:
    """Options under which a small scene takes seconds."""
    return OPTIONS


@pytest.fixture
def empty(tmp_path: Path) -> Path:
    """Where models may go."""
    return tmp_path / "models"


@pytest.fixture
def watched_closely(monkeypatch: pytest.MonkeyPatch) -> None:
    """Processes looked at so often that no stage ends unseen, however fast the machine is."""
    monkeypatch.setattr(engine, "POLL_SECONDS", 0.005)
