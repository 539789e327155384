"""Which model of a final is the best."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import polars as pl
import pytest

from aerocues.methods.combination import Combination
from aerocues.results.combination_columns import METHODS
from aerocues.results.reconstruction_schema import BASELINE
from aerocues.scoring.objectives import OBJECTIVES
from aerocues.tuning.final import Final, model_value

ORB, SIFT, STAR = (
    Combination.parse(name)
    for name in ("ORB-ORB-HAM-EXACT", "SIFT-SIFT-L2-EXACT", "STAR-BRISK-HAM-EXACT")
)


def model(combination: Combination, **figures: Any) -> dict[str, Any]:
    """A model of all ten images, 400 points, 1 px and 10 s: its quality is 20."""
    facts: dict[str, Any] = {
        **dict(zip(METHODS, str(combination).split("-"), strict=True)),
        "status": "ok",
        "images": 10,
        "registered_images": 10,
        "placed_images": None,
        "points_3d": 800,
        "points_in_3_images": 400,
        "mean_track_length": 3.5,
        "reprojection_error": 1.0,
        "position_rmse": None,
        "surface_error": None,
        "truth": None,
        "reconstruction_seconds": 10.0,
    }
    return {**facts, **figures}


def final(*rows: dict[str, Any], objective: str = "reconstruction") -> Final:
    table = pl.DataFrame(list(rows), infer_schema_length=None)
    asked = (ORB, SIFT, STAR)
    return Final.of_models(table, asked, (10, 10), Path("models"), OBJECTIVES[objective])


def detectors(found: Final) -> list[str]:
    return [row["detector"] for row in found.rows]


def test_what_loses_images_is_never_better() -> None:
    sharp = model(ORB, registered_images=9, reprojection_error=0.01)
    found = final(sharp, model(SIFT), model(STAR, status="misplaced", points_in_3_images=9000))
    assert detectors(found) == ["SIFT", "ORB", "STAR"]
    assert found.best == found.best_combination
    assert found.baseline is None
    assert found.unfinished == (str(BASELINE),)


def test_time_counts_by_the_objective() -> None:
    """Half as good again (1.5) against 16 times as fast: 16^0.1 = 1.32, 16^0.25 = 2."""
    rows = model(ORB), model(SIFT, points_in_3_images=900, reconstruction_seconds=160.0)
    for objective, first in (("reconstruction", "SIFT"), ("balanced", "SIFT"), ("speed", "ORB")):
        assert detectors(final(*rows, objective=objective))[0] == first
    assert model_value(rows[0], OBJECTIVES["speed"]) == pytest.approx(20 / 10**0.25)


def test_colmaps_default_may_be_the_best() -> None:
    found = final(model(SIFT), model(BASELINE, reprojection_error=0.5))
    assert found.best is found.baseline
    assert found.best_combination is not None
    assert found.best_combination["detector"] == "SIFT"
    assert found.unfinished == (str(ORB), str(STAR))


def test_colmaps_default_alone_has_beaten_nothing() -> None:
    found = final(model(BASELINE))
    assert found.best is None
    assert found.baseline is not None


def test_a_final_without_a_model_has_no_best() -> None:
    found = final(model(SIFT, status="no_model", registered_images=None))
    assert found.best is None
    assert found.best_combination is None


def test_models_of_others_in_the_folder_do_not_take_part() -> None:
    other = model(Combination.parse("AKAZE-AKAZE-HAM-EXACT"), points_in_3_images=9000)
    assert detectors(final(other, model(SIFT))) == ["SIFT"]
