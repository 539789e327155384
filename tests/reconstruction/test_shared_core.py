"""What measuring and reconstructing share: thresholds of presets, and features that were kept."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import polars as pl
import pytest

import aerocues
from aerocues.datasets.dataset import Dataset
from aerocues.methods.presets import Preset
from aerocues.reconstruction.models import Models
from tests.reconstruction.scenes import Options

pytestmark = pytest.mark.slow


def test_the_thresholds_of_a_preset_decide_the_model(
    landscape: Dataset, models: Models, empty: Path, quick: Options
) -> None:
    strict = Preset("strict", "half a pixel", chance_test=True, thresholds={"ORB-ORB": 0.5})
    made = aerocues.reconstruct(landscape, "ORB-ORB-HAM-BF", empty, preset=strict, **quick).table()
    usual = models.table().filter(pl.col("detector") == "ORB")
    assert made["matches"].to_list() == usual["matches"].to_list()
    assert made["verified_matches"][0] < usual["verified_matches"][0]
    assert made["points_3d"][0] != usual["points_3d"][0]
    assert made["row_key"][0] != usual["row_key"][0]


def test_features_that_a_run_kept_are_used_again(
    landscape: Dataset, models: Models, empty: Path, tmp_path: Path, quick: Options
) -> None:
    kept = tmp_path / "features"
    results = aerocues.run(
        replace(landscape, pairs=[*landscape.pairs[:5]]),
        "ORB-ORB-HAM-BF",
        tmp_path / "results",
        max_keypoints=quick["max_keypoints"],
        timing="shared",
        features=kept,
    )
    before = {file: file.stat().st_mtime_ns for file in kept.rglob("*.npz")}
    assert len(before) == 2 * len(landscape.images)
    made = aerocues.reconstruct(
        landscape, "ORB-ORB-HAM-BF", empty, results=results.folder, **quick
    ).table()
    assert {file: file.stat().st_mtime_ns for file in kept.rglob("*.npz")} == before
    usual = models.table().filter(pl.col("detector") == "ORB")
    for name in ("matches", "registered_images", "points_3d"):
        assert made[name].to_list() == usual[name].to_list()
    assert not (empty / "features").exists()
