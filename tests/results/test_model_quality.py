"""Which model is the best, by hand."""

from __future__ import annotations

import polars as pl
import pytest

from aerocues.results.model_quality import best_first, model_order, model_quality
from aerocues.results.reconstructions import reconstruction_table

ROW = {
    "dataset": "flight",
    "detector": "ORB",
    "descriptor": "ORB",
    "norm": "HAM",
    "matcher": "BF",
    "status": "ok",
    "images": 20,
    "registered_images": 20,
    "points_3d": 5000,
    "points_in_3_images": 3200,
    "reprojection_error": 0.5,
}


def test_quality_by_hand() -> None:
    assert model_quality(ROW) == pytest.approx(80)  # sqrt(3200 / 0.5)
    assert model_quality({**ROW, "placed_images": 15}) == pytest.approx(60)
    by_gps = {**ROW, "truth": "gps", "position_rmse": 2.0}
    assert model_quality(by_gps) == pytest.approx(80)
    by_poses = {**ROW, "truth": "poses", "position_rmse": 2.0}
    assert model_quality(by_poses) == pytest.approx(40)
    assert model_quality({**by_poses, "surface_error": 0.125}) == pytest.approx(160)


def test_no_model_has_no_quality() -> None:
    assert model_quality({**ROW, "registered_images": None}) is None
    assert model_quality({**ROW, "points_in_3_images": None}) is None
    assert model_quality({**ROW, "reprojection_error": None}) is None


def test_success_comes_before_quality_and_quality_before_size() -> None:
    sharp = {**ROW, "detector": "SIFT", "points_3d": 3300, "reprojection_error": 0.25}
    broken = {**ROW, "detector": "AGAST", "status": "incomplete", "reprojection_error": 0.01}
    lost = {**ROW, "detector": "KAZE", "status": "no_model", "registered_images": None}
    table = reconstruction_table(pl.DataFrame([lost, ROW, broken, sharp]))
    assert best_first(table)["detector"].to_list() == ["SIFT", "ORB", "AGAST", "KAZE"]
    assert table.filter(detector="ORB")["model_quality"].item() == pytest.approx(80)


def test_figures_made_elsewhere_are_sorted_by_size() -> None:
    imported = {"status": "ok", "points_3d": 900, "reprojection_error": 0.1}
    larger = {**imported, "points_3d": 1000, "reprojection_error": 0.9}
    assert model_order(larger) < model_order(imported)
