"""Models of a final are made of the features that the race has found."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from aerocues.datasets.dataset import Dataset
from aerocues.methods.combination import Combination
from aerocues.modelling.final import MODELS
from aerocues.processes.call import StageCall
from aerocues.reconstruction.combination_model import CombinationModel
from aerocues.reconstruction.images import cameras_of, prepare_image
from aerocues.reconstruction.judging import CLOUD
from aerocues.reconstruction.models import Models
from aerocues.reconstruction.options import ReconstructionOptions
from aerocues.reconstruction.protocol import ReconstructionProtocol
from aerocues.reconstruction.scene import FEATURES, Scene
from aerocues.reconstruction.scene_making import scene_of
from aerocues.results.clouds import read_cloud
from aerocues.tuning.recommend import RaceOptions, recommend_by_race
from aerocues.tuning.recommendation import Recommendation
from tests.made_once import made_once
from tests.reconstruction.scenes import write_scene

ORB = Combination.parse("ORB-ORB-HAM-EXACT")
KEYPOINTS = 700
KEPT = f"{MODELS}/{FEATURES}"


@pytest.fixture(scope="module")
def four(tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    """Four of the photographs, with all of their pairs."""
    whole = made_once(tmp_path_factory, "landscape", write_scene)[1]
    images = whole.images[:4]
    names = {image.name for image in images}
    pairs = [pair for pair in whole.pairs if {pair.image_1, pair.image_2} <= names]
    return replace(whole, images=images, pairs=pairs)


@pytest.fixture(scope="module")
def raced(four: Dataset, tmp_path_factory: pytest.TempPathFactory) -> Recommendation:
    return recommend_by_race(
        *(four, "ORB-ORB-HAM-BF,FAST-BRIEF-HAM-BF", tmp_path_factory.mktemp("raced") / "race"),
        RaceOptions(3600.0, features=KEPT),
        max_keypoints=KEYPOINTS,
        workers=1,
    )


def scene(found: Recommendation, dataset: Dataset, folder: Path) -> Scene:
    """The scene of a final in a folder; the images are not prepared yet."""
    protocol = ReconstructionProtocol(max_keypoints=KEYPOINTS)
    return scene_of(dataset, folder, ReconstructionOptions(found.preset, protocol))


def made(found: Recommendation, dataset: Dataset, folder: Path) -> tuple[Any, set[str]]:
    """The row of the model, and the stages that it took."""
    Models.create(folder)
    there = scene(found, dataset, folder)
    prepared = [prepare_image(image, there.images) for image in dataset.images]
    there = replace(there, cameras=cameras_of(dataset, prepared, there.protocol))
    stages = set()

    def announce(call: StageCall) -> None:
        stages.add(call.stage)

    return CombinationModel(there, ORB, announce).make(), stages


@pytest.mark.slow
def test_models_with_and_without_features_of_the_race_are_the_same(
    raced: Recommendation, four: Dataset, tmp_path: Path
) -> None:
    assert (raced.folder / KEPT / "ORB-ORB").is_dir()
    reused, short = made(raced, four, raced.folder / MODELS)
    anew, long = made(raced, four, tmp_path / MODELS)
    assert long - short == {"detect", "describe"}
    assert reused["status"] == anew["status"] == "ok"
    assert {name: reused[name] for name in reused if not name.endswith("_seconds")} == {
        name: anew[name] for name in anew if not name.endswith("_seconds")
    }
    of_race, of_its_own = (
        read_cloud(file.read_bytes(), file).points
        for file in (place / MODELS / str(ORB) / CLOUD for place in (raced.folder, tmp_path))
    )
    assert len(of_race)
    np.testing.assert_array_equal(of_race, of_its_own)
