"""`aerocues validate` where there are 3D models."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import polars as pl
import pytest

from aerocues.cli.relations_table import relations_table
from aerocues.results.combination_columns import METHODS
from aerocues.results.measured_results import Results
from aerocues.results.store import Store
from aerocues.scoring.outcomes import relate_outcomes
from tests.cli.conftest import Call
from tests.report.made_up import folder_of, measured


def models_of(results: Results) -> pl.DataFrame:
    """Made-up models of the combinations that were measured."""
    known = results.table().select("dataset", *METHODS).unique().sort(METHODS)
    return known.with_columns(
        pl.lit("ok").alias("status"),
        pl.int_range(len(known)).mul(100).add(40).alias("points_3d"),
        pl.int_range(len(known)).truediv(9).add(0.3).alias("reprojection_error"),
        pl.int_range(len(known)).add(3.0).alias("reconstruction_seconds"),
        pl.lit("one").alias("settings_key"),
    )


@pytest.mark.slow
def test_relations_to_models_are_told(tmp_path: Path, call: Call) -> None:
    results = folder_of(measured(), tmp_path)
    folder = results.folder
    assert "3D models" not in call("validate", folder).out
    Store.open(folder).add_reconstructions(models_of(results))
    answer = call("validate", folder)
    assert answer.code == 0
    assert "points" in answer.out.split("3D models")[1]
    facts = json.loads(call("validate", folder, "--json").out)["reconstruction"]
    assert {"feature", "outcome", "pearson", "spearman"} <= set(facts[0])
    table = relations_table(relate_outcomes(results))
    assert table.columns == ["name", "combinations", "pearson", "spearman"]
    assert f"{facts[0]['feature']} -> {facts[0]['outcome']}" == table["name"][0]
    assert table["name"].is_unique().all()


def test_few_models_are_too_few_to_tell(finished: Path, tmp_path: Path, call: Call) -> None:
    folder = tmp_path / "results"
    shutil.copytree(finished, folder)
    Store.open(folder).add_reconstructions(models_of(Results(folder)))
    reason = json.loads(call("validate", folder, "--json").out)["reconstruction"]
    assert reason.startswith("4 combinations")
    assert "'aerocues reconstruct'" in reason
    assert reason in " ".join(call("validate", folder).out.split("3D models")[1].split())


def test_models_that_all_failed_are_left_out_of_the_score(
    finished: Path, tmp_path: Path, call: Call
) -> None:
    folder = tmp_path / "results"
    shutil.copytree(finished, folder)
    measured = Results(folder).table().select("dataset", *METHODS).unique()
    failed = measured.with_columns(
        pl.lit("misplaced").alias("status"),
        pl.lit(500).alias("points_3d"),
        pl.lit("one").alias("settings_key"),
    )
    before = call("score", folder).out
    Store.open(folder).add_reconstructions(failed)
    assert call("score", folder).out == before
    asked = call("score", folder, "--reconstruction")
    assert asked.code == 2
    assert "reprojection_error, points_3d" in asked.err
