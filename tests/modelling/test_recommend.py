"""A recommendation whose leaders build models of the images."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import cv2
import pytest

import aerocues
from aerocues.datasets.dataset import Dataset
from aerocues.reconstruction.models import Models
from aerocues.results.combination_columns import name_in_row
from aerocues.results.reconstruction_schema import BASELINE
from tests.made_once import made_once
from tests.reconstruction.scenes import write_scene

FEW = "SIFT-SIFT-L2-BF,ORB-ORB-HAM-BF,AKAZE-AKAZE-HAM-FLANN"
OPTIONS: dict[str, Any] = {"budget": "1h", "max_keypoints": 500, "max_pairs": 4, "workers": 2}


@pytest.fixture(scope="module")
def landscape(tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    return made_once(tmp_path_factory, "landscape", write_scene)[1]


@pytest.mark.slow
def test_the_best_model_decides_unless_the_race_is_to(landscape: Dataset, tmp_path: Path) -> None:
    alone = aerocues.recommend(landscape, FEW, tmp_path / "race", final=False, **OPTIONS)
    assert alone.final is None
    assert alone.best == alone.leader
    assert not (tmp_path / "race" / "models").exists()

    found = aerocues.recommend(landscape, FEW, tmp_path / "race", **OPTIONS)
    final = found.final
    assert final is not None
    assert (final.images, final.of) == (6, 6)
    assert final.unfinished == ()
    names = [name_in_row(row) for row in final.rows]
    assert sorted(names) == sorted(
        [
            str(BASELINE),
            "SIFT-SIFT-L2-EXACT",
            "ORB-ORB-HAM-EXACT",
            "AKAZE-AKAZE-HAM-EXACT",
        ]
    )
    assert found.best == names[0]
    told = found.facts()["final"]
    assert (told["models"], told["images"], told["of"]) == (names, 6, 6)
    assert final.rows[0]["status"] == "ok"
    assert final.rows[0]["placed_images"] == 6
    # The models are there to be used, and in the results.
    models = Models(tmp_path / "race" / "models")
    assert models.cloud(found.best) is not None
    stored = aerocues.Results(tmp_path / "race").reconstructions()
    assert len(stored) == 4

    # Once more: nothing is made again.
    before = {row["reconstructed_at"] for row in final.rows}
    again = aerocues.recommend(landscape, FEW, tmp_path / "race", **OPTIONS)
    assert again.final is not None
    assert {row["reconstructed_at"] for row in again.final.rows} == before
    assert again.best == found.best


@pytest.mark.slow
def test_images_without_a_focal_length_have_a_final(landscape: Dataset, tmp_path: Path) -> None:
    """The images are flat: COLMAP's default does not determine it either. One is upside down."""
    photos = tmp_path / "photos"
    photos.mkdir()
    for number, image in enumerate(landscape.images[:4]):
        pixels = image.read().bgr
        cv2.imwrite(str(photos / image.name), pixels[::-1, ::-1] if number == 1 else pixels)
    found = aerocues.recommend(
        photos, "SIFT-SIFT-L2-BF,ORB-ORB-HAM-BF", tmp_path / "race", upright=True, **OPTIONS
    )
    assert found.final is not None
    [model] = [row for row in found.final.rows if row["detector"] == "ORB"]
    assert json.loads(model["parameters"])["turned"] == {landscape.images[1].name: 180}
