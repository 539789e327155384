"""3D models in the report: what the page, the text and the figures get of them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import polars as pl
import pytest

import aerocues
from aerocues.evaluation.store import Store
from aerocues.report.clouds import MOST_POINTS, clouds_of
from aerocues.report.entry import entry_facts
from aerocues.report.figures import write_figures
from aerocues.report.markdown import summary
from aerocues.report.payload import payload_of
from aerocues.report.report import report_entries, write_report
from aerocues.report.size import fitting_clouds, size_of
from tests.report.decoding import floats, scaled
from tests.report.made_up import folder_of, measured
from tests.report.made_up_models import MODELLED, with_models


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> aerocues.Results:
    """Results with six models; three succeeded."""
    return with_models(tmp_path_factory.mktemp("models"))


def models_of(results: aerocues.Results) -> Any:
    [found] = report_entries([results])
    return entry_facts(found)["models"]


def test_the_page_gets_every_reconstruction(results: aerocues.Results) -> None:
    models = models_of(results)
    assert models["combinations"] == sorted(MODELLED)
    by_name = dict(zip(models["combinations"], models["status"], strict=True))
    assert by_name[MODELLED[3]] == "misplaced"
    assert models["reference"] == MODELLED[0]
    columns = {column["name"]: column for column in models["columns"]}
    assert columns["points_3d"]["better"] == "higher"
    assert columns["cloud_distance_rms"]["unit"] == "m"
    assert "rotation_error" not in columns  # nobody knows it
    relations = models["relations"]
    assert "points_3d" in relations["outcomes"]
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
    [found] = report_entries([results])
    assert clouds_of(found).clouds == []


def test_clouds_that_are_worth_a_look_come_first(tmp_path: Path) -> None:
    results = with_models(tmp_path, points=MOST_POINTS + 500)
    [found] = report_entries([results])
    clouds = clouds_of(found).clouds
    names = [cloud["combination"] for cloud in clouds]
    assert names[0] == MODELLED[0]
    assert "reference of the distances" in clouds[0]["why"]
    assert MODELLED[3] in names  # the bent one, to be seen
    assert MODELLED[5] not in names  # without a model
    points = scaled(clouds[0]["points"], -1)
    assert points.size == 3 * MOST_POINTS
    assert clouds[0]["all_points"] == MOST_POINTS + 500
    assert clouds_of(found).clouds == clouds  # the same sample again


def test_a_damaged_cloud_is_noted(tmp_path: Path) -> None:
    results = with_models(tmp_path)
    Store.open(results.folder).cloud_files()[0].write_bytes(b"half a cloud")
    [found] = report_entries([results])
    assert any("is damaged" in note for note in clouds_of(found).notes)


def test_clouds_give_way_where_there_is_no_room(results: aerocues.Results) -> None:
    [found] = report_entries([results])
    every = clouds_of(found)
    room = sum(map(size_of, every.clouds[:2])) + 10
    kept = fitting_clouds([every], room)
    assert kept.clouds == every.clouds[:2]
    left = len(every.clouds) - 2
    assert kept.notes == [
        f"{left} of {len(every.clouds)} clouds are left out to keep the page small "
        "(--max-megabytes)"
    ]
    assert payload_of([found], "title", clouds=kept)["clouds"][0]["combination"] == MODELLED[0]


def test_models_without_a_scale_are_laid_upright(tmp_path: Path) -> None:
    results = with_models(tmp_path, unit="unit")
    [found] = report_entries([results])
    clouds = clouds_of(found).clouds
    assert {cloud["unit"] for cloud in clouds} == {"unit"}
    for cloud in clouds:
        heights = floats(cloud["centres"], -1, 3)[:, 2]
        assert heights.min() > scaled(cloud["points"], -1, 3)[:, 2].mean()


def test_the_report_holds_the_clouds(results: aerocues.Results, tmp_path: Path) -> None:
    page = write_report(results, tmp_path / "report.html", pictures=0).read_text()
    assert '"clouds":[{"entry":' in page
    assert "<bent>" not in page


def test_the_text_tells_of_models(results: aerocues.Results) -> None:
    text = summary(report_entries([results]), "Models")
    assert "3D models: 3 of 6 reconstructions succeeded." in text
    assert f"- `{MODELLED[0]}`: 12 of 12 images, 12,000 points, 0.60 px, cameras" in text
    assert "- failed: misplaced 1, incomplete 1, no verified pair 1" in text


def test_figures_of_models_are_drawn(results: aerocues.Results, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib", reason="matplotlib is not installed")
    names = {path.name for path in write_figures(report_entries([results]), tmp_path)}
    assert {"models.svg", "models.pdf", "models-relation.svg"} <= names
    drawn = (tmp_path / "models.svg").read_text()
    assert "registered images" in drawn
    assert MODELLED[0] in drawn
