"""Refined keypoints in a model, and the limit of the mapper that goes with their error."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pycolmap
import pytest

import aerocues
from aerocues.datasets.dataset import Dataset
from aerocues.methods.arrays import Keypoints
from aerocues.pipeline.protocol import Refinement
from aerocues.reconstruction.matched_scene import MatchedScene, PairMatches
from aerocues.reconstruction.models import Models
from aerocues.reconstruction.precision import keypoint_error
from aerocues.reconstruction.protocol import ErrorLimit, ReconstructionProtocol
from aerocues.reconstruction.refining import GrayImages, refine_scene
from tests.reconstruction.scenes import Options

pytestmark = pytest.mark.slow

ORB = "ORB-ORB-HAM-BF"
NOTHING = ("refinable_share", "refined_share", "refinement_shift", "refinement_gain")


def test_refined_keypoints_are_sharper(models: Models) -> None:
    for row in models.table().to_dicts():
        assert 0.5 < row["refinable_share"] <= row["refined_share"] <= 1
        assert 0 < row["refinement_shift"] < 1.5
        assert row["keypoint_error"] < 0.3
        assert row["error_limit"] == 1
    [orb] = [row for row in models.table().to_dicts() if row["detector"] == "ORB"]
    assert orb["refinement_gain"] > 3


def test_a_model_of_refined_keypoints_is_nearer_to_the_truth(
    models: Models, landscape: Dataset, quick: Options, empty: Path
) -> None:
    made = aerocues.reconstruct(landscape, ORB, empty, refine_keypoints=False, **quick)
    [before] = made.table().to_dicts()
    [after] = [row for row in models.table().to_dicts() if row["detector"] == "ORB"]
    assert all(before[name] is None for name in NOTHING)
    assert before["matches"] == after["matches"]
    assert before["keypoint_error"] > 2 * after["keypoint_error"]
    assert before["error_limit"] >= 1
    assert after["reprojection_error"] < before["reprojection_error"]
    assert after["position_rmse"] < before["position_rmse"]


def test_the_thesis_takes_keypoints_as_they_are_unless_told(
    landscape: Dataset, quick: Options, empty: Path
) -> None:
    made = aerocues.reconstruct(landscape, ORB, empty, preset="thesis", **quick)
    [row] = made.table().to_dicts()
    assert all(row[name] is None for name in (*NOTHING, "keypoint_error", "error_limit"))
    told = aerocues.reconstruct(
        landscape, ORB, empty, preset="thesis", refine_keypoints=True, **quick
    )
    [row] = told.table().to_dicts()
    assert row["refined_share"] > 0.5
    assert row["error_limit"] is None


def test_what_is_left_out_has_no_part_in_the_identity_of_a_model() -> None:
    plain = ReconstructionProtocol(refinement=None, error_limit=None).identity()
    assert "refinement" not in plain
    assert "error_limit" not in plain
    assert ReconstructionProtocol().identity() != plain


def test_the_error_of_keypoints_is_measured(models: Models, tmp_path: Path) -> None:
    place = models.path(ORB)
    [row] = [row for row in models.table().to_dicts() if row["detector"] == "ORB"]
    assert keypoint_error(place / "database.db") == pytest.approx(row["keypoint_error"])
    # A pixel of noise in each coordinate is found again.
    noisy = tmp_path / "noisy.db"
    shutil.copyfile(place / "database.db", noisy)
    random = np.random.default_rng(0)
    database = pycolmap.Database.open(noisy)
    for image in database.read_all_images():
        found = database.read_keypoints(image.image_id)
        found[:, :2] += random.normal(0, 1, (len(found), 2))
        database.update_keypoints(image.image_id, found)
    database.close()
    # Where a homography is all that is known of a pair, relief counts, too.
    assert 1 < (keypoint_error(noisy) or 0) < 1.25


def test_the_error_of_nothing_is_not_known(tmp_path: Path) -> None:
    pycolmap.Database.open(tmp_path / "empty.db").close()
    assert keypoint_error(tmp_path / "empty.db") is None


@pytest.mark.parametrize(
    ("error", "pixels"), [(None, 4.0), (0.1, 1.0), (0.5, 1.0), (0.8, 1.6), (3.0, 4.0)]
)
def test_the_limit_follows_the_error_within_bounds(error: float | None, pixels: float) -> None:
    assert ErrorLimit(factor=2.0, least=1.0, most=4.0).pixels(error) == pytest.approx(pixels)


def test_gray_images_stay_within_their_memory(landscape: Dataset) -> None:
    images = GrayImages(landscape, 0.5, most=3 * 480 * 360 * 4)
    first = images(0)
    assert first.dtype == np.float32
    assert first.shape == (360, 480)
    assert images(0) is first
    for number in range(1, 6):
        images(number)
    assert images(0) is not first
    np.testing.assert_array_equal(images(0), first)


def test_matches_of_what_is_rejected_are_left_out(landscape: Dataset) -> None:
    names = [image.name for image in landscape.images[:2]]
    random = np.random.default_rng(1)
    # Matched at random: hardly any patch looks like that of its match.
    places = random.uniform([40, 40], [440, 320], (60, 2)).astype(np.float32)
    keypoints = {
        names[0]: Keypoints.from_xy(places),
        names[1]: Keypoints.from_xy(random.permutation(places)),
    }
    rows = np.column_stack([np.arange(60)] * 2).astype(np.int32)
    pair = (names[0], names[1])
    matched = MatchedScene(keypoints, {pair: PairMatches(rows, np.zeros(60, np.float32))}, 0, 0)
    sharper, found = refine_scene(landscape, matched, Refinement())
    assert found.observations == 60
    assert len(sharper.pairs[pair]) == found.accepted < 20
    assert len(matched.pairs[pair]) == 60
