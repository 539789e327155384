"""Writing the report from Python, for results of all kinds."""

from __future__ import annotations

from pathlib import Path

import pytest

import aerocues
from aerocues import Results
from aerocues.errors import ScoreError, StoreError
from tests.report.decoding import payload_in
from tests.report.made_up import COMBINATIONS, folder_of, measured


def test_results_can_report(flight: Results, tmp_path: Path) -> None:
    page = aerocues.write_report(flight, tmp_path / "page.html", title="Mine", resamples=50)
    assert page == tmp_path / "page.html"
    assert payload_in(page)["title"] == "Mine"


def test_all_that_makes_results_makes_such_that_can_report(
    finished: Results, flight: Results
) -> None:
    assert isinstance(finished, Results)
    assert isinstance(flight, Results)
    assert isinstance(aerocues.Results(finished.folder), Results)


def test_packed_results_are_reported_on_as_well(flight: Results, tmp_path: Path) -> None:
    packed = aerocues.Results(flight.pack(tmp_path / "packed.zip"))
    page = aerocues.write_report([packed], tmp_path / "page.html", resamples=50)
    assert len(payload_in(page)["entries"][0]["combinations"]) == len(COMBINATIONS)


def test_scoring_can_be_set(flight: Results, tmp_path: Path) -> None:
    page = aerocues.write_report(
        flight,
        tmp_path / "page.html",
        criteria=["precision", "inliers"],
        preset="thesis",
        alpha=0.25,
        resamples=20,
        seed=7,
    )
    [entry] = payload_in(page)["entries"]
    settings = entry["score"]["settings"]
    assert settings["criteria"] == ["precision", "inliers"]
    assert (settings["preset"], settings["alpha"]) == ("thesis", 0.25)
    assert (settings["resamples"], settings["seed"]) == (20, 7)


def test_an_existing_page_is_replaced(flight: Results, tmp_path: Path) -> None:
    page = tmp_path / "page.html"
    page.write_text("old")
    assert (
        "old"
        not in aerocues.write_report(flight, page, resamples=50).read_text(encoding="utf-8")[:9]
    )


def test_a_page_that_cannot_be_written(flight: Results, tmp_path: Path) -> None:
    with pytest.raises(StoreError, match=r"page\.html"):
        aerocues.write_report(flight, tmp_path / "missing" / "page.html", resamples=50)


def test_results_without_rows(tmp_path: Path, flight: Results) -> None:
    folder = folder_of(measured(pairs=1), tmp_path).folder
    for part in (folder / "parts").glob("*.parquet"):
        part.unlink()
    with pytest.raises(ScoreError):
        aerocues.write_report(aerocues.Results(folder), tmp_path / "page.html")


def test_results_that_suit_different_presets(tmp_path: Path, flight: Results) -> None:
    without = folder_of(measured(dataset="other", chance_inliers=None), tmp_path)
    with pytest.raises(ScoreError, match="preset"):
        aerocues.write_report([flight, without], tmp_path / "page.html")


def test_results_tell_where_their_images_are(finished: Results, photos: Path) -> None:
    source = finished.settings["dataset"]["source"]
    assert source["spec"] == str(photos)
    assert aerocues.open_dataset(**source).images
