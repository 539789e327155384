"""COLMAP's default beside the combinations."""

from __future__ import annotations

import shutil
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import pycolmap
import pytest

import aerocues
from aerocues.datasets.dataset import Dataset, Image
from aerocues.datasets.decoding import FileSource
from aerocues.progress import Event
from aerocues.reconstruction import baseline
from aerocues.reconstruction.models import Models
from aerocues.results.metrics import Row
from aerocues.results.reconstruction_schema import BASELINE
from tests.made_once import made_once
from tests.reconstruction.scenes import Options, scene_of, write_scene

SIFT = "SIFT-SIFT-L2-FLANN"
OPTIONS: Options = {"max_keypoints": 1500, "seed": 3}


@pytest.fixture(scope="module")
def photographs(tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    """Nine photographs, as six do not determine the camera; one has a space in its name."""

    def make(folder: Path) -> Dataset:
        square = [(x, y) for y in (-9.0, 0.0, 9.0) for x in (-9.0, 0.0, 9.0)]
        others = write_scene(folder, square, truth=False).images[1:]
        first = (folder / "view_0.png").rename(folder / "view 0.png")
        return scene_of([Image(first.name, FileSource(first)), *others])

    return made_once(tmp_path_factory, "photographs", make)[1]


@pytest.fixture(scope="module")
def compared(photographs: Dataset, tmp_path_factory: pytest.TempPathFactory) -> Models:
    """COLMAP's default and one combination, of images whose focal length is not known."""

    def make(folder: Path) -> None:
        aerocues.reconstruct(photographs, SIFT, folder, workers=1, **OPTIONS)

    return Models(made_once(tmp_path_factory, "compared", make)[0])


def rows_of(models: Models) -> dict[str, Row]:
    return {row["detector"]: row for row in models.table().to_dicts()}


def finished(events: list[Event]) -> list[str]:
    return [row["detector"] for event in events for row in event.rows]


@pytest.mark.slow
def test_it_is_a_row_like_the_others(compared: Models) -> None:
    row = rows_of(compared)["COLMAP"]
    assert (row["status"], row["registered_images"], row["images"]) == ("ok", 9, 9)
    assert (row["pairs"], row["pairing"], row["max_keypoints"]) == (36, "exhaustive", 1500)
    assert row["intrinsics"] == "refined (guessed)"
    stages = ("feature", "matching", "verification", "mapping")
    seconds = [row[f"{stage}_seconds"] for stage in stages]
    assert min(seconds) > 0
    assert row["reconstruction_seconds"] == pytest.approx(sum(seconds))
    assert 0 < row["verified_matches"] <= row["matches"]
    assert row["model_quality"] > 0
    assert compared.cloud(BASELINE) is not None
    assert rows_of(compared)["SIFT"]["settings_key"] == row["settings_key"]


@pytest.mark.slow
def test_it_is_what_colmap_makes_alone(compared: Models, tmp_path: Path) -> None:
    images = compared.folder / "images"
    extraction, matching = pycolmap.FeatureExtractionOptions(), pycolmap.FeatureMatchingOptions()
    extraction.num_threads = matching.num_threads = 1
    extraction.sift.max_num_features = 1500
    verification = pycolmap.TwoViewGeometryOptions()
    verification.ransac.random_seed = 3
    database = tmp_path / "alone.db"
    pycolmap.set_random_seed(3)
    pycolmap.extract_features(
        database,
        images,
        camera_mode=pycolmap.CameraMode.SINGLE,
        extraction_options=extraction,
        device=pycolmap.Device.cpu,
    )
    pycolmap.match_exhaustive(
        database,
        matching_options=matching,
        verification_options=verification,
        device=pycolmap.Device.cpu,
    )
    mapping = pycolmap.IncrementalPipelineOptions()
    mapping.num_threads, mapping.random_seed = 1, 3
    alone = pycolmap.incremental_mapping(database, images, tmp_path, mapping)[0]
    row = rows_of(compared)["COLMAP"]
    assert row["registered_images"] == alone.num_reg_images()
    assert row["points_3d"] == pytest.approx(alone.num_points3D(), rel=0.02)
    error = alone.compute_mean_reprojection_error()
    assert row["reprojection_error"] == pytest.approx(error, rel=0.02)


@pytest.mark.slow
def test_its_camera_is_that_of_the_others(compared: Models) -> None:
    rows = rows_of(compared)
    assert rows["SIFT"]["intrinsics"] == "fixed (calibrated)"
    assert rows["SIFT"]["focal_length"] == pytest.approx(rows["COLMAP"]["focal_length"], rel=1e-3)
    assert rows["SIFT"]["focal_length"] == pytest.approx(420, rel=0.01)
    assert compared.settings["calibration"]["message"].startswith("intrinsics: calibrated")


@pytest.mark.slow
def test_it_is_made_once(compared: Models, photographs: Dataset, tmp_path: Path) -> None:
    copy = tmp_path / "copy"
    shutil.copytree(compared.folder, copy)
    events: list[Event] = []
    again = aerocues.reconstruct(photographs, SIFT, copy, progress=events.append, **OPTIONS)
    assert finished(events) == []
    assert again.table().equals(compared.table())
    without = aerocues.reconstruct(photographs, SIFT, copy, baseline=False, **OPTIONS)
    assert list(rows_of(without)) == ["SIFT"]
    # Its features and matches are kept: only the model is made again.
    (copy / str(BASELINE) / "cloud.npz").unlink()
    aerocues.reconstruct(photographs, SIFT, copy, progress=events.append, **OPTIONS)
    assert finished(events) == ["COLMAP"]
    mine = (copy / str(BASELINE) / "sparse" / "0" / "points3D.bin").read_bytes()
    theirs = compared.path(BASELINE) / "sparse" / "0" / "points3D.bin"
    assert mine == theirs.read_bytes()
    row = rows_of(Models(copy))["COLMAP"]
    assert row["feature_seconds"] == rows_of(compared)["COLMAP"]["feature_seconds"]


def test_large_scenes_get_the_pairs_of_the_others(landscape: Dataset) -> None:
    pairing, pairs = baseline.baseline_pairs(replace(landscape, pairs=landscape.pairs[:5]))
    assert (pairing, len(pairs)) == ("exhaustive", 15)
    images = [replace(landscape.images[0], name=f"{number}.png") for number in range(51)]
    consecutive = [(one.name, other.name) for one, other in pairwise(images)]
    large = replace(scene_of(images, consecutive), settings=(("pairs", "consecutive"),))
    assert baseline.baseline_pairs(large) == ("consecutive", consecutive)


def test_older_versions_of_colmap_go_without(monkeypatch: pytest.MonkeyPatch) -> None:
    assert baseline.baseline_problem() is None
    monkeypatch.setattr(baseline, "major_minor", lambda: (3, 13))
    assert "4.0" in str(baseline.baseline_problem())
