"""Measurements on images of which poses and depth are known."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import polars as pl
import pytest
from numpy.typing import NDArray

from aerocues.datasets.dataset import Dataset
from aerocues.errors import ImageError
from aerocues.evaluation import run as running
from tests.evaluation.inline import InlineEngine
from tests.evaluation.scenes import PLAIN
from tests.made_once import made_once
from tests.reconstruction.scenes import write_scene

run = partial(running.run, engine=InlineEngine(), timing="shared")
pytestmark = pytest.mark.slow

PAIRS = [("view_0.png", "view_1.png")]


class Gone:
    """Depth that was there when the run was planned."""

    def read(self) -> NDArray[np.float32]:
        raise ImageError("the depth is gone; simulate the flight again")

    def content_key(self) -> str:
        return "gone"


@pytest.fixture(scope="module")
def views(tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    places = [(-3.0, 0.0), (3.0, 0.0)]
    make = partial(write_scene, places=places, pairs=PAIRS)
    return made_once(tmp_path_factory, "two-views", make)[1]


@pytest.fixture(scope="module")
def rows(views: Dataset, tmp_path_factory: pytest.TempPathFactory) -> pl.DataFrame:
    combinations = "SIFT-SIFT-L2-BF,ORB-ORB-HAM-BF,STAR-LATCH-HAM-BF"

    def make(folder: Path) -> pl.DataFrame:
        return run(views, combinations, folder).table().sort("detector")

    return made_once(tmp_path_factory, "compared-with-truth", make)[1]


def test_matches_keypoints_and_pose_are_compared_with_the_truth(rows: pl.DataFrame) -> None:
    good = rows.filter(pl.col("detector") != "STAR")
    assert good["status"].to_list() == ["ok", "ok"]
    # Inliers lie within 3 px of a line; what is right lies within 3 px of a point.
    assert (good["gt_precision@3"] <= good["precision"] + 0.02).all()
    assert (good["gt_precision@3"] > good["precision"] - 0.15).all()
    assert (good["gt_precision@5"] >= good["gt_precision@3"]).all()
    assert (good["gt_precision@1"] > 0.3).all()
    expected = good["gt_precision@3"] * good["matches"] / good["keypoints_1"]
    np.testing.assert_allclose(good["gt_matching_score@3"], expected)
    assert good["gt_repeatability"].is_between(0.4, 1).all()
    assert (good["pose_error"] < 3).all()
    np.testing.assert_allclose(good["pose_auc@10"], 1 - good["pose_error"] / 10)
    assert good["homography_error"].null_count() == 2


def test_what_matches_nothing_right_has_a_wrong_pose(rows: pl.DataFrame) -> None:
    bad = rows.filter(pl.col("detector") == "STAR").row(0, named=True)
    assert bad["gt_precision@3"] < 0.2
    assert bad["pose_error"] > 5
    assert bad["pose_auc@5"] == 0


def test_without_depth_the_pose_alone_is_compared(views: Dataset, tmp_path: Path) -> None:
    images = [
        replace(image, truth=replace(image.truth, depth=None) if image.truth else None)
        for image in views.images
    ]
    without = replace(views, images=images)
    row = run(without, "SIFT-SIFT-L2-BF", tmp_path / "out", preset=PLAIN).table().row(0, named=True)
    assert row["pose_error"] < 3
    assert row["gt_precision@3"] is None
    assert row["gt_repeatability"] is None


def test_another_truth_is_another_measurement(views: Dataset, tmp_path: Path) -> None:
    first = run(views, "ORB-ORB-HAM-BF", tmp_path / "out", preset=PLAIN).table().row(0, named=True)
    view = views.images[1].truth
    assert view is not None
    moved = replace(views.images[1], truth=replace(view, centre=view.centre + np.array([0, 3, 0])))
    other = replace(views, images=[views.images[0], moved])
    again = run(other, "ORB-ORB-HAM-BF", tmp_path / "out", preset=PLAIN).table().row(0, named=True)
    assert again["row_key"] != first["row_key"]
    assert again["inliers"] == first["inliers"]
    assert again["pose_error"] > first["pose_error"] + 10


def test_depth_that_cannot_be_read_is_an_error_of_its_rows(views: Dataset, tmp_path: Path) -> None:
    view = views.images[1].truth
    assert view is not None
    broken = replace(views.images[1], truth=replace(view, depth=Gone()))
    dataset = replace(views, images=[views.images[0], broken])
    row = run(dataset, "ORB-ORB-HAM-BF", tmp_path / "out", preset=PLAIN).table().row(0, named=True)
    assert row["status"] == "error"
    assert "the depth is gone" in row["message"]
