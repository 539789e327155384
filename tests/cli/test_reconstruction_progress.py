"""What is told while models are made."""

from __future__ import annotations

import pytest

from aerocues.cli.reconstruction_progress import Reporter, summary
from aerocues.methods.combination import Combination

METHODS = {"detector": "ORB", "descriptor": "ORB", "norm": "HAM", "matcher": "BF"}
MADE = {
    "registered_images": 12,
    "images": 18,
    "points_3d": 1323,
    "reprojection_error": 0.967,
    "position_rmse": 0.672,
}


def test_a_model_in_one_line() -> None:
    made = {**METHODS, **MADE, "status": "incomplete", "message": "the model holds ..."}
    assert summary(made) == "incomplete: 12 of 18 images, 1,323 points, 0.97 px, 0.7 m"
    # The reason stands below the table at the end.
    assert summary({"status": "no_features", "message": "2 of 3 images have no keypoints"}) == (
        "no_features"
    )
    assert summary({"status": "no_model", "message": None}) == "no_model"


def test_plain_lines_count_what_is_there(capsys: pytest.CaptureFixture[str]) -> None:
    reporter = Reporter()
    reporter.preparing(1, 2)
    reporter.left_out([Combination.parse("ORB-LUCID-HAM-BF")], "images are gray")
    reporter.planned(3, 1)
    reporter.working([])
    reporter.finished({**METHODS, **MADE, "status": "ok"})
    assert capsys.readouterr().err.splitlines() == [
        "left out: 1 combination, because images are gray",
        "1 of 3 models already exist",
        "2 of 3  ORB-ORB-HAM-BF  ok: 12 of 18 images, 1,323 points, 0.97 px, 0.7 m",
    ]
