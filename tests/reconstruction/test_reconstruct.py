"""From images to models: figures against the truth, files that others read, repetition."""

from __future__ import annotations

import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pycolmap
import pytest
from plyfile import PlyData

import aerocues
from aerocues.datasets.dataset import Dataset
from aerocues.errors import ReconstructionError, StoreError
from aerocues.progress import Event
from aerocues.reconstruction.models import Models
from aerocues.results.metrics import Row
from tests.reconstruction.scenes import Options, scene_of

pytestmark = pytest.mark.slow

SIFT = "SIFT-SIFT-L2-FLANN"
MODEL = ["cameras.bin", "frames.bin", "images.bin", "points3D.bin", "rigs.bin"]


class Counting:
    """Remembers what was done."""

    def __init__(self) -> None:
        self.rows: list[Row] = []
        self.present = 0

    def __call__(self, event: Event) -> None:
        if event.stage == "reconstructing":
            self.rows += [dict(row) for row in event.rows]
            self.present = event.done - len(self.rows)


def row_of(models: Models, combination: str) -> Row:
    detector = combination.split("-", maxsplit=1)[0]
    return next(row for row in models.table().to_dicts() if row["detector"] == detector)


def test_a_model_agrees_with_the_truth(models: Models) -> None:
    row = row_of(models, SIFT)
    assert row["status"] == "ok"
    assert (row["images"], row["registered_images"], row["components"]) == (6, 6, 1)
    assert row["truth"] == "poses"
    assert row["position_rmse"] < 0.05
    assert row["position_error_share"] == pytest.approx(row["position_rmse"] / 20.12, rel=0.01)
    assert row["rotation_error"] < 0.1
    assert row["surface_error"] < 0.1
    assert row["focal_length"] == 420
    assert row["reprojection_error"] < 0.2
    assert row["intrinsics"] == "fixed (truth)"
    assert (row["reference"], row["cloud_distance_rms"]) == (SIFT, 0)


def test_figures_are_those_of_colmap(models: Models) -> None:
    for row in models.table().to_dicts():
        name = "-".join(row[part] for part in ("detector", "descriptor", "norm", "matcher"))
        model = pycolmap.Reconstruction(str(models.path(name) / "sparse" / "0"))
        assert row["registered_images"] == model.num_reg_images()
        assert row["points_3d"] == model.num_points3D()
        assert row["observations"] == model.compute_num_observations()
        assert row["mean_track_length"] == pytest.approx(model.compute_mean_track_length())
        error = model.compute_mean_reprojection_error()
        assert row["reprojection_error"] == pytest.approx(error)
        assert row["pairs"] == 15
        assert row["verified_pairs"] <= row["linked_pairs"] <= 15
        assert 0 < row["verified_matches"] < row["matches"]
        stages = ("feature", "matching", "verification", "refinement", "mapping")
        seconds = [row[f"{stage}_seconds"] for stage in stages]
        assert min(seconds) > 0
        assert row["reconstruction_seconds"] == pytest.approx(sum(seconds))


def test_every_file_opens_elsewhere(models: Models) -> None:
    place = models.path(SIFT)
    text = pycolmap.Reconstruction(str(place / "text"))
    assert text.num_points3D() == row_of(models, SIFT)["points_3d"]
    cloud = PlyData.read(str(place / "points.ply"))["vertex"]
    assert len(cloud) == text.num_points3D()
    assert len(np.unique(cloud["red"])) > 20
    assert models.picture(SIFT).read_bytes().startswith(b"\x89PNG")
    database = pycolmap.Database.open(place / "database.db")
    assert database.num_images() == 6
    assert database.num_verified_image_pairs() == row_of(models, SIFT)["verified_pairs"]
    database.close()
    found = models.cloud(SIFT)
    assert found is not None
    assert found.unit == "m"
    np.testing.assert_allclose(found.centres, found.positions, atol=0.1)
    # Cameras look down, and the image's y runs to the south.
    np.testing.assert_allclose(found.rotations[:, 2, 2], -1, atol=0.02)
    assert np.median(found.points[:, 2]) < 9.5


@pytest.mark.skipif(shutil.which("colmap") is None, reason="Debian's colmap is not installed")
def test_colmap_itself_reads_the_model(models: Models) -> None:
    words = ["colmap", "model_analyzer", "--path", str(models.path(SIFT) / "sparse" / "0")]
    told = subprocess.run(words, capture_output=True, text=True, check=True)
    assert f"Points: {row_of(models, SIFT)['points_3d']}" in told.stdout + told.stderr


def test_models_of_one_folder_share_its_table_and_its_reference(models: Models) -> None:
    assert models.table()["detector"].to_list() == ["ORB", "SIFT"]
    assert models.table()["reference"].to_list() == [SIFT, SIFT]


def test_damaged_files_are_made_again_the_same_and_then_nothing_is(
    models: Models, landscape: Dataset, quick: Options, tmp_path: Path
) -> None:
    copy = tmp_path / "copy"
    shutil.copytree(models.folder, copy)
    place = copy / SIFT
    (place / "outcome.json").write_text("{ half")
    (place / "database.db").write_bytes(b"this is no database" * 1000)
    (place / "matches.npz").write_bytes(b"PK\x03\x04 nor is this")
    first = Counting()
    again = aerocues.reconstruct(landscape, SIFT, copy, progress=first, **quick)
    assert first.present == 0
    assert [row["status"] for row in first.rows] == ["ok"]
    for name in MODEL:
        mine = (again.path(SIFT) / "sparse" / "0" / name).read_bytes()
        assert mine == (models.path(SIFT) / "sparse" / "0" / name).read_bytes(), name
    assert again.cloud(SIFT).content() == models.cloud(SIFT).content()  # type: ignore[union-attr]

    second = Counting()
    aerocues.reconstruct(landscape, SIFT, copy, progress=second, **quick)
    assert (second.present, second.rows) == (1, [])

    # Other settings of the mapper: a new model out of the same matches.
    third = Counting()
    changed = aerocues.reconstruct(
        landscape, SIFT, copy, progress=third, **{**quick, "mapper": "global"}
    )
    [row] = third.rows
    assert row["matching_seconds"] == first.rows[0]["matching_seconds"]
    assert (row["status"], row["mapper"]) == ("ok", "global")
    assert row_of(changed, SIFT)["position_rmse"] < 0.2


def test_refined_intrinsics_and_undistorted_images(
    landscape: Dataset, quick: Options, empty: Path
) -> None:
    images = [replace(image, truth=None) for image in landscape.images]
    options = {**quick, "intrinsics": "refine", "colours": False, "undistort": True}
    made = aerocues.reconstruct(scene_of(images), SIFT, empty, **options)
    row = row_of(made, SIFT)
    assert row["status"] == "ok"
    assert row["intrinsics"] == "refined (guessed)"
    assert row["position_rmse"] is None
    assert (row["length_unit"], row["cloud_distance_rms"]) == ("unit", 0)
    dense = made.path(SIFT) / "undistorted"
    assert len(list((dense / "images").iterdir())) == 6
    assert pycolmap.Reconstruction(str(dense / "sparse")).num_reg_images() == 6


def test_a_focal_length_that_is_not_known_must_be_given_to_stay_fixed(
    landscape: Dataset, quick: Options, empty: Path
) -> None:
    images = [replace(image, truth=None) for image in landscape.images]
    with pytest.raises(ReconstructionError, match=r"6 of 6 .* `focal_length`"):
        aerocues.reconstruct(scene_of(images), SIFT, empty, **{**quick, "intrinsics": "fixed"})


def test_scenes_that_have_no_depth_are_refused(empty: Path) -> None:
    with pytest.raises(ReconstructionError, match="homograph"):
        aerocues.reconstruct("synthetic", SIFT, empty)


def test_several_scenes_must_be_told_apart(landscape: Dataset, empty: Path) -> None:
    pairs = [replace(pair, sequence=f"part {pair.index % 2}") for pair in landscape.pairs]
    with pytest.raises(ReconstructionError, match=r"2 scenes .* `sequences`"):
        aerocues.reconstruct(replace(landscape, pairs=pairs), SIFT, empty)


def test_a_reference_must_be_among_the_combinations(landscape: Dataset, empty: Path) -> None:
    with pytest.raises(ReconstructionError, match="ORB-ORB-HAM-BF"):
        aerocues.reconstruct(landscape, SIFT, empty, reference="ORB-ORB-HAM-BF")
    with pytest.raises(ReconstructionError, match="combinations"):
        aerocues.reconstruct(landscape, output=empty)


def test_models_do_not_mix_with_other_files(landscape: Dataset, empty: Path) -> None:
    empty.mkdir()
    (empty / "letter.txt").write_text("dear")
    with pytest.raises(StoreError, match=r"letter\.txt"):
        aerocues.reconstruct(landscape, SIFT, empty)
    with pytest.raises(StoreError, match=str(empty)):
        Models(empty)


def test_a_failure_leaves_nothing_of_an_earlier_model(
    models: Models, landscape: Dataset, quick: Options, tmp_path: Path, watched_closely: None
) -> None:
    copy = tmp_path / "copy"
    shutil.copytree(models.folder, copy)
    options = {**quick, "max_keypoints": 999, "timeout": 0.02}
    failed = aerocues.reconstruct(landscape, SIFT, copy, **options)
    row = row_of(failed, SIFT)
    assert row["status"] == "timeout"
    assert (row["reference"], row["cloud_distance_rms"]) == (None, None)
    seen = Counting()
    aerocues.reconstruct(landscape, SIFT, copy, progress=seen, **quick)
    assert seen.present == 0
    assert seen.rows[0]["points_3d"] == row_of(models, SIFT)["points_3d"]


def test_files_that_are_gone_are_made_again(
    models: Models, landscape: Dataset, quick: Options, tmp_path: Path
) -> None:
    copy = tmp_path / "copy"
    shutil.copytree(models.folder, copy)
    (copy / SIFT / "cloud.npz").write_bytes(b"half")
    seen = Counting()
    again = aerocues.reconstruct(landscape, SIFT, copy, progress=seen, **quick)
    assert len(seen.rows) == 1
    assert again.cloud(SIFT) is not None


def test_other_truth_or_other_names_are_another_scene(
    models: Models, landscape: Dataset, quick: Options, tmp_path: Path
) -> None:
    moved = []
    for number, image in enumerate(landscape.images):
        assert image.truth is not None
        centre = image.truth.centre + np.array([60.0 * (-1) ** number, 0, 0])
        moved.append(replace(image, truth=replace(image.truth, centre=centre)))
    copy = tmp_path / "moved"
    shutil.copytree(models.folder, copy)
    made = aerocues.reconstruct(replace(landscape, images=moved), SIFT, copy, **quick)
    row = row_of(made, SIFT)
    assert row["status"] == "misplaced"
    assert row["matching_seconds"] == row_of(models, SIFT)["matching_seconds"]

    names = {image.name: f"new_{image.name}" for image in landscape.images}
    renamed = replace(
        landscape,
        images=[replace(image, name=names[image.name]) for image in landscape.images],
        pairs=[
            replace(pair, image_1=names[pair.image_1], image_2=names[pair.image_2])
            for pair in landscape.pairs
        ],
    )
    again = aerocues.reconstruct(renamed, SIFT, copy, **quick)
    assert row_of(again, SIFT)["status"] == "ok"


def test_a_pair_in_both_orders_is_matched_once(
    landscape: Dataset, quick: Options, empty: Path
) -> None:
    three = scene_of(landscape.images[:3])
    turned = [
        replace(pair, index=100 + pair.index, image_1=pair.image_2, image_2=pair.image_1)
        for pair in three.pairs
    ]
    twice = replace(three, pairs=[*three.pairs, *turned])
    row = row_of(aerocues.reconstruct(twice, SIFT, empty, **quick), SIFT)
    assert (row["status"], row["pairs"]) == ("ok", 3)
