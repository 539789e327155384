"""3D models in the report: what the page, the text and the figures get of them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import polars as pl
import pytest

import aerocues
from aerocues.report import figures
from aerocues.report.clouds import clouds_of
from aerocues.report.entry import entry_facts
from aerocues.report.figures import write_figures
from aerocues.report.markdown import summary
from aerocues.report.report import report_entries, write_report
from aerocues.results.store import Store
from tests.report.made_up import folder_of, measured
from tests.report.made_up_models import MODELLED, with_models


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> aerocues.Results:
    """Results with six models; three succeeded."""
    return with_models(tmp_path_factory.mktemp("models"))


def models_of(results: aerocues.Results) -> Any:
    [found] = report_entries([results], resamples=50)
    return entry_facts(found)["models"]


def test_the_page_gets_every_reconstruction(results: aerocues.Results) -> None:
    models = models_of(results)
    assert sorted(models["combinations"]) == sorted(MODELLED)
    assert models["baseline"] is None
    by_name = dict(zip(models["combinations"], models["status"], strict=True))
    assert models["status"] == sorted(models["status"], key=lambda status: status != "ok")
    assert by_name[MODELLED[3]] == "misplaced"
    assert models["reference"] == MODELLED[0]
    columns = {column["name"]: column for column in models["columns"]}
    assert columns["points_3d"]["better"] == "higher"
    assert columns["cloud_distance_rms"]["unit"] == "m"
    assert "rotation_error" not in columns  # nobody knows it
    relations = models["relations"]
    assert relations["outcomes"] == ("registered_images",)  # of others three are too few
    assert len(relations["spearman"]) == len(relations["features"])


def test_without_reconstructions_there_is_nothing(flight: aerocues.Results) -> None:
    assert models_of(flight) is None
    [found] = report_entries([flight])
    assert clouds_of(found).clouds == []


def test_imported_figures_are_enough(tmp_path: Path) -> None:
    results = folder_of(measured(), tmp_path)
    named = results.table().select("dataset", "detector", "descriptor", "norm", "matcher").unique()
    figures = named.with_columns(
        pl.lit("ok").alias("status"),
        pl.int_range(len(named)).add(100).alias("points_3d"),
        pl.int_range(len(named)).add(0.5).alias("reprojection_error"),
        pl.lit(3.0).alias("reconstruction_seconds"),
    )
    Store.open(results.folder).write_reconstructions(figures)
    models = models_of(results)
    assert [column["name"] for column in models["columns"]] == [
        "points_3d",
        "reprojection_error",
        "reconstruction_seconds",
    ]
    [found] = report_entries([results], resamples=50)
    assert clouds_of(found).clouds == []


def test_the_report_holds_the_clouds(results: aerocues.Results, tmp_path: Path) -> None:
    page = write_report(results, tmp_path / "report.html", pictures=0).read_text()
    assert '"clouds":[{"entry":' in page
    assert "<bent>" not in page


def test_the_text_tells_of_models(results: aerocues.Results) -> None:
    text = summary(report_entries([results], resamples=50), "Models")
    assert "3 of 6" in text
    assert f"- `{MODELLED[0]}`: 12 of 12 images, 12,000 points, 0.60 px, cameras" in text
    assert "misplaced 1, incomplete 1, no verified pair 1" in text


@pytest.mark.slow
def test_figures_of_models_are_drawn(
    results: aerocues.Results, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("matplotlib", reason="matplotlib is not installed")
    kept = {name: figures.FIGURES[name] for name in ("models", "models-relation")}
    monkeypatch.setattr(figures, "FIGURES", kept)
    names = {path.name for path in write_figures(report_entries([results], resamples=50), tmp_path)}
    assert {"models.svg", "models.pdf", "models-relation.svg"} <= names
    drawn = (tmp_path / "models.svg").read_text()
    assert "registered images" in drawn
    assert MODELLED[0] in drawn
