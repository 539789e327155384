"""Clouds in the page: which, how they are packed, and what there is room for."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest

import aerocues
from aerocues import Results
from aerocues.report import clouds
from aerocues.report.arrays import packed_scaled
from aerocues.report.cloud_frames import in_one_frame
from aerocues.report.clouds import Clouds, clouds_of
from aerocues.report.entry import ReportEntry
from aerocues.report.payload import payload_of
from aerocues.report.report import report_entries
from aerocues.report.size import fitting_clouds, size_of
from aerocues.results.clouds import Cloud
from aerocues.results.store import Store
from tests.report.decoding import floats, numbers, payload_in, scaled
from tests.report.made_up import COMBINATIONS
from tests.report.made_up_models import MODELLED, STATUSES, cloud_of, made_models, with_models


@pytest.fixture(scope="module")
def modelled(tmp_path_factory: pytest.TempPathFactory) -> Results:
    return with_models(tmp_path_factory.mktemp("modelled"))


@pytest.fixture(scope="module")
def entry(modelled: Results) -> ReportEntry:
    [found] = report_entries([modelled], resamples=20)
    return found


def models_in(found: ReportEntry) -> dict[str, Any]:
    [facts] = payload_of([found], "title")["entries"]
    return dict(facts["models"])


def test_too_few_models_have_no_relations(tmp_path: Path) -> None:
    [found] = report_entries([with_models(tmp_path, COMBINATIONS[:2])], resamples=20)
    assert "2 combinations" in models_in(found)["relations"]["unavailable"]


def test_the_reference_comes_first_and_failures_are_shown(entry: ReportEntry) -> None:
    found = clouds_of(entry)
    by_name = {cloud["combination"]: cloud["why"] for cloud in found.clouds}
    assert next(iter(by_name)) == MODELLED[0]
    assert by_name[MODELLED[0]].startswith("reference of the distances; best by CUES")
    assert by_name[MODELLED[STATUSES.index("misplaced")]] == "largest position errors"
    assert by_name[MODELLED[STATUSES.index("incomplete")]] == "fewest images"
    assert MODELLED[STATUSES.index("no_verified_pair")] not in by_name
    assert found.notes == []


def test_points_and_cameras_come_back(entry: ReportEntry) -> None:
    packed = clouds_of(entry).clouds[0]
    cloud = entry.results.cloud(f"{0:032x}")
    assert cloud is not None
    np.testing.assert_allclose(scaled(packed["points"]).reshape(-1, 3), cloud.points, atol=0.01)
    np.testing.assert_allclose(scaled(packed["errors"]), cloud.errors, atol=0.01)
    np.testing.assert_array_equal(numbers(packed["colours"], -1, 3), cloud.colours)
    np.testing.assert_array_equal(floats(packed["centres"], -1, 3), cloud.centres)
    np.testing.assert_array_equal(floats(packed["positions"], -1, 3), cloud.positions)
    assert (packed["all_points"], packed["strays"], packed["unit"]) == (300, 0, "m")


def test_a_limited_number_of_clouds(entry: ReportEntry, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(clouds, "MOST_CLOUDS", 4)
    assert len(clouds_of(entry).clouds) == 4


def test_strays_are_left_out_and_counted(tmp_path: Path) -> None:
    results = with_models(tmp_path)
    cloud = cloud_of()
    cloud.points[7] = (1e6, 0, 0)
    Store.open(results.folder).write_cloud(f"{0:032x}", cloud)
    [found] = report_entries([results], resamples=20)
    packed = clouds_of(found).clouds[0]
    assert packed["strays"] == 1
    assert packed["points"]["high"] < 1000


@pytest.mark.slow
def test_clouds_that_are_missing_or_damaged_cost_only_themselves(tmp_path: Path) -> None:
    results = with_models(tmp_path)
    (results.folder / "clouds" / f"{0:032x}.npz").write_bytes(b"no cloud")
    (results.folder / "clouds" / f"{1:032x}.npz").unlink()
    [found] = report_entries([results], resamples=20)
    shown = clouds_of(found)
    assert not {MODELLED[0], MODELLED[1]} & {cloud["combination"] for cloud in shown.clouds}
    assert len(shown.notes) == 1
    assert MODELLED[0] in shown.notes[0]
    page = aerocues.write_report(results, tmp_path / "page.html", resamples=20)
    assert shown.notes[0] in payload_in(page)["method"]["notes"]


def test_what_has_no_scale_is_brought_into_one_frame() -> None:
    first, second = (cloud_of(seed=seed, unit="unit") for seed in (0, 0))
    angle = np.radians(50)
    turned = np.array(
        [[1, 0, 0], [0, np.cos(angle), -np.sin(angle)], [0, np.sin(angle), np.cos(angle)]]
    )
    other = Cloud(
        **{
            **vars(second),
            "points": np.float32(3 * second.points @ turned.T + 5),
            "centres": np.float32(3 * second.centres @ turned.T + 5),
        }
    )
    placed = in_one_frame([first, other])
    np.testing.assert_allclose(placed[1].points, placed[0].points, atol=0.05)
    # Upright: the cameras are above the points.
    assert placed[0].centres[:, 2].min() > np.quantile(placed[0].points[:, 2], 0.9)
    metric = cloud_of()
    assert in_one_frame([metric]) == [metric]


def test_the_first_of_every_entry_come_before_the_second_of_any() -> None:
    found = [
        Clouds([{"entry": name, "number": n, "x": "y" * 100} for n in range(3)]) for name in "ab"
    ]
    size = size_of(found[0].clouds[0])
    kept = fitting_clouds(found, 3 * size)
    assert [(each["entry"], each["number"]) for each in kept.clouds] == [
        ("a", 0),
        ("b", 0),
        ("a", 1),
    ]
    assert kept.notes == ["3 of 6 clouds are left out to keep the page small"]
    assert fitting_clouds(found, 6 * size).notes == []


@pytest.mark.slow
def test_a_page_has_no_more_clouds_than_it_may(modelled: Results, tmp_path: Path) -> None:
    whole = aerocues.write_report(modelled, tmp_path / "whole.html", resamples=20)
    room = whole.stat().st_size - 10_000
    small = aerocues.write_report(
        modelled, tmp_path / "small.html", resamples=20, max_megabytes=room / 1e6
    )
    assert small.stat().st_size <= room
    shown = [len(payload_in(page)["clouds"]) for page in (whole, small)]
    assert 0 < shown[1] < shown[0] == 5
    assert any("clouds are left out" in note for note in payload_in(small)["method"]["notes"])


@pytest.mark.parametrize("values", [[0.0, 1.0, 0.25, float("nan")], [3.0, 3.0], [-123456.7, 9.0]])
def test_scaled_numbers_come_back(values: list[float]) -> None:
    known = [value for value in values if np.isfinite(value)]
    low, high = min(known), max(known)
    back = scaled(packed_scaled(values, low, high))
    np.testing.assert_allclose(back, values, atol=(high - low) / 65534 + 1e-4 * abs(low))


def test_numbers_beyond_the_bounds_are_put_on_them() -> None:
    assert scaled(packed_scaled([-5, 0.5, 7], 0, 1)).tolist() == pytest.approx(
        [0, 0.5, 1], abs=1e-4
    )


def test_reconstructions_of_other_datasets_are_of_others(tmp_path: Path) -> None:
    results = with_models(tmp_path)
    other = made_models()[0].with_columns(dataset=pl.lit("elsewhere"))
    Store.open(results.folder).write_reconstructions(other)
    [found] = report_entries([results], resamples=20)
    assert found.models.is_empty()
