"""Four photographs under two combinations, and what a target writes of them."""

from __future__ import annotations

import shutil
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from aerocues.datasets.dataset import Dataset
from aerocues.exports.flight import Flight, linked_flight
from aerocues.exports.targets import target_named
from aerocues.reconstruction.options import ReconstructionOptions
from aerocues.reconstruction.protocol import ReconstructionProtocol
from tests.made_once import made_once
from tests.reconstruction.scenes import write_scene

KEYPOINTS = 400


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    """Four photographs, each paired with each."""
    whole = made_once(tmp_path_factory, "landscape", write_scene)[1]
    kept = whole.images[:4]
    names = {image.name for image in kept}
    pairs = [pair for pair in whole.pairs if {pair.image_1, pair.image_2} <= names]
    return replace(whole, images=kept, pairs=pairs)


@pytest.fixture(scope="module", params=["SIFT-SIFT-L2-BF", "ORB-BRISK-HAM-BF"])
def flight(
    scene: Dataset, request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> Flight:
    """The scene under a combination with numbers, and under one with bits."""
    options = ReconstructionOptions(
        protocol=ReconstructionProtocol(0, KEYPOINTS, "refine"), refine_keypoints=False, workers=1
    )
    name = f"flight-{request.param}"
    make = partial(linked_flight, scene, request.param, options=options)
    return made_once(tmp_path_factory, name, make)[1]


def written(flight: Flight, target: str, folder: Path) -> list[str]:
    """Write the files of a target from a copy of the flight; the next commands."""
    work = folder.with_name("work")
    shutil.copytree(flight.scene.folder, work)
    scene = replace(flight.scene, folder=work, features=work / "features")
    folder.mkdir()
    commands: list[str] = target_named(target).load()(replace(flight, scene=scene), folder)
    for name in ("images", "sensors/records_data"):
        place = folder / name
        if place.is_dir():
            assert {path.name for path in place.iterdir()} == set(flight.images)
    return commands


def xy_of(flight: Flight, name: str) -> NDArray[np.float32]:
    return flight.linked.keypoints[name].xy
