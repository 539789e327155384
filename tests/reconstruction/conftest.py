"""One small scene and its models, which tests read."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

import aerocues
from aerocues.datasets.dataset import Dataset
from aerocues.reconstruction.models import Models
from aerocues.reconstruction.options import ReconstructionOptions
from aerocues.reconstruction.protocol import ReconstructionProtocol
from tests.reconstruction.scenes import write_scene

OPTIONS = ReconstructionOptions(protocol=ReconstructionProtocol(max_keypoints=1000))
COMBINATIONS = "SIFT-SIFT-L2-FLANN,ORB-ORB-HAM-BF"


@pytest.fixture(scope="session")
def landscape(tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    """Nine photographs with known poses and depth."""
    return write_scene(tmp_path_factory.mktemp("landscape") / "images")


@pytest.fixture(scope="session")
def models(landscape: Dataset, tmp_path_factory: pytest.TempPathFactory) -> Models:
    """Models of the landscape; tests change nothing in them."""
    options = replace(OPTIONS, workers=1)
    return aerocues.reconstruct(
        landscape, tmp_path_factory.mktemp("models") / "models", COMBINATIONS, options=options
    )


@pytest.fixture
def quick() -> ReconstructionOptions:
    """Options under which a small scene takes seconds."""
    return OPTIONS


@pytest.fixture
def empty(tmp_path: Path) -> Path:
    """Where models may go."""
    return tmp_path / "models"
