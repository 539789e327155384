"""What the page is told."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import aerocues
from aerocues import Results
from aerocues.errors import ScoreError
from aerocues.report.payload import payload_of
from aerocues.report.report import default_title, report_entries
from tests.report.decoding import floats, numbers
from tests.report.made_up import COMBINATIONS, folder_of, measured

SHAPE = (5, 6)


@pytest.fixture(scope="module")
def entry(flight: Results) -> dict[str, Any]:
    [found] = payload_of(report_entries([flight], resamples=50), "title")["entries"]
    return dict(found)


def test_every_combination_and_pair_is_named_once(entry: dict[str, Any]) -> None:
    assert sorted(entry["combinations"]) == sorted(COMBINATIONS)
    assert [pair["pair"] for pair in entry["pairs"]] == list(range(6))
    first = entry["combinations"].index("GFTT_H-DAISY-L2-FLANN")
    parts = [entry[kind][first] for kind in ("detector", "descriptor", "norm", "matcher")]
    assert parts == ["GFTT_H", "DAISY", "L2", "FLANN"]


def test_figures_of_pairs_stand_where_they_were_measured(
    entry: dict[str, Any],
    flight: Results,
) -> None:
    inliers = floats(entry["columns"]["inliers"]["values"], *SHAPE)
    for row in flight.table().iter_rows(named=True):
        name = "-".join(row[kind] for kind in ("detector", "descriptor", "norm", "matcher"))
        value = inliers[entry["combinations"].index(name), row["pair"]]
        if row["status"] == "ok":
            assert value == row["inliers"]
        else:
            assert np.isnan(value)


def test_times_of_a_failed_pair_are_kept(entry: dict[str, Any]) -> None:
    detect = floats(entry["columns"]["detect_seconds"]["values"], *SHAPE)
    assert not np.isnan(detect).any()
    assert np.isnan(floats(entry["columns"]["total_seconds"]["values"], *SHAPE)).sum() == 1


def test_statuses_are_told_pair_by_pair(entry: dict[str, Any]) -> None:
    status = numbers(entry["status"], *SHAPE)
    names = [entry["statuses"][number] for number in status.ravel()]
    assert {name: names.count(name) for name in set(names)} == entry["counts"]
    assert entry["counts"] == {"ok": 28, "error": 1, "chance": 1}
    assert {each["status"] for each in entry["failures"]} == {"error", "chance"}
    assert entry["statuses"][-1] == "not measured"


def test_scores_are_those_of_the_ranking(
    entry: dict[str, Any],
    flight: Results,
) -> None:
    frame = aerocues.score(flight).frame("combination")
    score = entry["score"]
    assert entry["combinations"][score["best"]] == frame["combination"][0]
    for row in frame.iter_rows(named=True):
        position = entry["combinations"].index(row["combination"])
        assert score["rank"][position] == row["rank"]
        assert score["score"][position] == pytest.approx(row["score"], abs=1e-4)
        assert score["success_rate"][position] == pytest.approx(row["success_rate"], abs=1e-4)
    names = [criterion["name"] for criterion in score["criteria"]]
    assert list(score["means"]) == names
    for method in score["weights"]["methods"]:
        assert sum(score["weights"]["values"][method]) == pytest.approx(1, abs=1e-3)


@pytest.mark.parametrize(
    ("kinds", "told"),
    [
        (["exclusive"], "exclusive"),
        (["exclusive", "scaled"], "sampled"),
        (["exclusive", "scaled", "shared"], "mixed"),
        (["shared", "exclusive"], "mixed"),
        ([None], "unknown"),
    ],
)
def test_the_page_is_told_where_times_come_from(
    tmp_path: Path, kinds: list[str | None], told: str
) -> None:
    rows = measured(pairs=4)
    for number, each in enumerate(rows):
        each["timing"] = kinds[number % len(kinds)]
    results = folder_of(rows, tmp_path / "results")
    [found] = payload_of(report_entries([results], resamples=50), "title")["entries"]
    assert found["timing"] == told


def test_special_choices_are_named(entry: dict[str, Any]) -> None:
    score = entry["score"]
    assert entry["norm"][score["best_binary"]] == "HAM"
    good = score["score"][score["best"]] * score["settings"]["good"]
    assert score["score"][score["fastest_good"]] >= good - 1e-4


def test_definitions_and_reasons_are_there(flight: Results) -> None:
    payload = payload_of(report_entries([flight], resamples=50), "title")
    defined = {column["name"]: column["definition"] for column in payload["method"]["columns"]}
    assert "inlier ratio" in defined["precision"]
    assert "Towards Efficient 3D Reconstruction" in payload["method"]["citation"]
    assert "Hamming" in payload["incompatible"]["SIFT-SIFT-HAM-BF"]
    assert "SIFT-SIFT-L2-BF" not in payload["incompatible"]
    assert payload["comparison"] is None
    json.dumps(payload, allow_nan=False)


def test_machines_are_compared(two_machines: list[Results]) -> None:
    payload = payload_of(report_entries(two_machines, resamples=50), "title")
    assert [entry["name"] for entry in payload["entries"]] == ["flight (desk)", "flight (board)"]
    [machines] = payload["machines"]
    assert (machines["first"], machines["second"]) == ("flight (desk)", "flight (board)")
    assert {row["stage"] for row in machines["times"]} >= {"detect", "match", "total"}
    comparison = payload["comparison"]
    assert comparison["names"] == ["flight (desk)", "flight (board)"]
    for row in comparison["versatility"]:
        assert len(row["scores"]) == len(row["ranks"]) == 2


def test_data_sets_without_a_common_combination_are_not_compared(tmp_path: Path) -> None:
    ones = measured(combinations=COMBINATIONS[:2])
    others = measured(combinations=COMBINATIONS[2:], dataset="other")
    results = [folder_of(ones, tmp_path / "one"), folder_of(others, tmp_path / "two")]
    assert payload_of(report_entries(results, resamples=50), "title")["comparison"] is None


def test_a_single_combination_on_a_single_pair(tmp_path: Path) -> None:
    results = folder_of(measured(combinations=COMBINATIONS[:1], pairs=1), tmp_path)
    [entry] = payload_of(report_entries([results], resamples=50), "title")["entries"]
    assert entry["score"]["rank"] == [1]
    assert entry["score"]["indistinguishable"] == []
    assert "unavailable" in entry["validation"]["critical_difference"]


def test_titles_name_what_was_measured(two_machines: list[Results]) -> None:
    entries = report_entries(two_machines, resamples=50)
    assert default_title(entries) == "Local features on flight (desk), flight (board)"


def test_nothing_to_report_on() -> None:
    with pytest.raises(ScoreError):
        report_entries([])


def test_a_folder_that_was_filled_in_two_runs(photos: Path, tmp_path: Path) -> None:
    for limit in (2, 1):
        dataset = aerocues.open_dataset(str(photos), max_pairs=limit)
        results = aerocues.run(dataset, "ORB-ORB-HAM-BF", tmp_path / "results", workers=1)
    [entry] = payload_of(report_entries([results], resamples=50), "title")["entries"]
    assert (entry["run"]["dataset"]["pairs"], entry["run"]["dataset"]["images"]) == (2, 3)
    assert len(entry["pairs"]) == 2
    assert "source" not in entry["run"]["dataset"]
    assert str(photos) not in json.dumps(entry)
