"""The whole way from a dataset to a table: statuses, resuming, plug-ins, exclusive times."""

from __future__ import annotations

import functools
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from aerocues.datasets.dataset import Dataset
from aerocues.errors import ArgumentError, SelectionError
from aerocues.evaluation import run as running
from aerocues.methods.presets import Preset
from aerocues.progress import Event
from aerocues.results.schema import COLUMNS
from tests.evaluation.inline import InlineEngine
from tests.evaluation.scenes import (
    assert_same_rows,
    rows_of,
    shift_of_strip,
    strip,
    write_dataset,
)
from tests.methods.arena import CODE, ENTRY_POINTS
from tests.methods.distribution import write_distribution
from tests.methods.pictures import textured

# Times are not the point: each pair is measured once.
run = functools.partial(running.run, timing="shared")
plan_run = functools.partial(running.plan_run, timing="shared")
FEW = "ORB-ORB-HAM-BF,ORB-BRIEF-HAM-FLANN,AKAZE-SIFT-L2-BF"


class Counting:
    """Counts the rows that were really measured."""

    def __init__(self) -> None:
        self.rows = 0

    def __call__(self, event: Event) -> None:
        self.rows += len(event.rows)


def test_views_of_a_plane_are_measured_with_the_truth(tmp_path: Path) -> None:
    truth = shift_of_strip()
    dataset = write_dataset(tmp_path / "images", strip(3), homographies=[truth, truth])
    results = run(dataset, FEW, tmp_path / "results", engine=InlineEngine())
    table = results.table()
    assert len(table) == 6
    for row in table.to_dicts():
        assert row["status"] == "ok", row["message"]
        assert row["message"] is None
        assert row["gt_precision@3"] > 0.8
        assert row["gt_repeatability"] > 0.3
        assert row["homography_error"] < 1
        assert row["homography_auc@3"] == pytest.approx(1 - row["homography_error"] / 3)
        assert 0 < row["inliers"] <= row["matches"] <= min(row["keypoints_1"], row["keypoints_2"])
        assert row["inliers"] > 1.4 * row["chance_inliers_max"] >= 1.4 * row["chance_inliers"]
        assert row["total_seconds"] > 0
        assert row["settings_key"] == results.settings["settings_key"]
        assert (row["timing"], row["seed"], row["preset"]) == ("shared", 0, "default")
        assert row["peak_memory_mb"] is None
    assert table["descriptor_bytes"].unique().sort().to_list() == [16, 32, 512]
    assert results.status().left == 0
    assert results.status().planned == 6
    assert len(results.settings["combinations"]) == 3


def test_the_second_run_measures_nothing(views: Dataset, tmp_path: Path) -> None:
    first, second = Counting(), Counting()
    before = rows_of(run(views, FEW, tmp_path / "r", engine=InlineEngine(), progress=first).table())
    after = rows_of(run(views, FEW, tmp_path / "r", engine=InlineEngine(), progress=second).table())
    assert (first.rows, second.rows) == (9, 0)
    assert before == after


def test_more_combinations_measure_only_the_new(views: Dataset, tmp_path: Path) -> None:
    run(views, "ORB-ORB-HAM-BF", tmp_path / "r", engine=InlineEngine())
    ((_, plan),) = plan_run(views, FEW, tmp_path / "r")
    assert (plan.rows_planned, plan.rows_present, plan.rows_left) == (9, 3, 6)
    counting = Counting()
    results = run(views, FEW, tmp_path / "r", engine=InlineEngine(), progress=counting)
    assert counting.rows == 6
    assert len(results.table()) == 9


def test_a_changed_image_is_measured_again(tmp_path: Path) -> None:
    pictures = strip(3)
    dataset = write_dataset(tmp_path / "images", pictures)
    before = rows_of(run(dataset, "ORB-ORB-HAM-BF", tmp_path / "r", engine=InlineEngine()).table())
    pictures["view_2.png"][40:90, 60:120] = 30
    dataset = write_dataset(tmp_path / "images", pictures)
    counting = Counting()
    results = run(
        dataset, "ORB-ORB-HAM-BF", tmp_path / "r", engine=InlineEngine(), progress=counting
    )
    after = rows_of(results.table())
    assert counting.rows == 1
    assert {name[1] for name in before if before[name] != after[name]} == {1}


@pytest.mark.slow
def test_another_seed_gives_a_table_of_its_own(views: Dataset, tmp_path: Path) -> None:
    run(views, "ORB-ORB-HAM-BF", tmp_path / "r", engine=InlineEngine())
    other = run(views, "ORB-ORB-HAM-BF", tmp_path / "r", seed=1, engine=InlineEngine())
    assert other.table()["seed"].to_list() == [1, 1, 1]
    again = Counting()
    back = run(views, "ORB-ORB-HAM-BF", tmp_path / "r", engine=InlineEngine(), progress=again)
    assert again.rows == 0
    assert back.table()["seed"].to_list() == [0, 0, 0]


@pytest.mark.slow
def test_images_without_content_end_in_a_status(tmp_path: Path) -> None:
    """Black, tiny, unrelated, truncated images and images of unequal size: a row each."""
    noise = np.random.default_rng(1).integers(0, 256, (2, 180, 240, 3)).astype(np.uint8)
    pictures = {
        "good.png": textured(240, 180, seed=5),
        "black.png": np.zeros((180, 240, 3), np.uint8),
        "tiny.png": textured(40, 30),
        "pixel.png": np.full((1, 1, 3), 90, np.uint8),
        "noise_1.png": noise[0],
        "noise_2.png": noise[1],
        "large.png": textured(420, 300, seed=5),
        "broken.png": textured(240, 180),
    }
    pairs = [
        ("good.png", "black.png"),
        ("tiny.png", "good.png"),
        ("good.png", "pixel.png"),
        ("noise_1.png", "noise_2.png"),
        ("good.png", "large.png"),
        ("broken.png", "good.png"),
        ("good.png", "good.png"),
        ("black.png", "broken.png"),
    ]
    dataset = write_dataset(tmp_path / "images", pictures, pairs)
    broken = tmp_path / "images" / "broken.png"
    broken.write_bytes(broken.read_bytes()[:4000])
    table = run(
        dataset,
        "FAST-FREAK-HAM-BF,ORB-ORB-HAM-BF,SIFT-SIFT-L2-*",
        tmp_path / "r",
        engine=InlineEngine(),
    ).table()
    assert len(table) == 8 * 4
    of = {(r["pair"], r["detector"], r["matcher"]): r for r in table.to_dicts()}

    def statuses(pair: int) -> set[str]:
        return {row["status"] for (number, _, _), row in of.items() if number == pair}

    assert statuses(0) == {"no_keypoints"}
    assert of[0, "SIFT", "BF"]["keypoints_1"] > 0
    assert of[0, "SIFT", "BF"]["keypoints_2"] == 0
    assert of[0, "SIFT", "BF"]["matches"] is None
    assert of[1, "FAST", "BF"]["status"] == "no_descriptors"
    assert "ok" not in statuses(1)
    assert statuses(2) <= {"no_keypoints", "error"}
    assert statuses(3) <= {"chance", "too_few_matches", "no_model"}
    assert "chance" in statuses(3)
    # Nothing moves between an image and itself: any matrix fits, or none.
    assert statuses(6) <= {"ok", "no_model"}
    assert of[6, "SIFT", "BF"]["matches"] == of[6, "SIFT", "BF"]["keypoints_1"]
    for pair in (5, 7):
        assert statuses(pair) == {"error"}
    assert statuses(4) <= {"ok", "chance"}
    guilty = {2: "pixel.png", 5: "broken.png", 7: "broken.png"}
    for (pair, _, _), row in of.items():
        if row["status"] == "error":
            assert guilty[pair] in row["message"]


def test_the_thesis_preset_does_not_ask_for_chance(tmp_path: Path) -> None:
    noise = np.random.default_rng(1).integers(0, 256, (2, 180, 240, 3)).astype(np.uint8)
    dataset = write_dataset(tmp_path / "images", {"a.png": noise[0], "b.png": noise[1]})
    table = run(
        dataset, "SIFT-SIFT-L2-BF", tmp_path / "r", preset="thesis", engine=InlineEngine()
    ).table()
    [row] = table.to_dicts()
    assert row["status"] == "ok"
    assert row["preset"] == "thesis"
    assert row["chance_inliers"] is None
    assert row["excess_inliers"] is None
    assert row["precision"] > 0


@pytest.mark.slow
def test_exclusive_times_say_so_and_know_the_memory(views: Dataset, tmp_path: Path) -> None:
    shared = run(views, FEW, tmp_path / "r", engine=InlineEngine()).table()
    assert shared["timing_repeats"].null_count() == 9
    exclusive = run(views, FEW, tmp_path / "r", timing="exclusive").table()
    assert exclusive["timing"].to_list() == ["exclusive"] * 9
    assert_same_rows(rows_of(exclusive), rows_of(shared))
    assert min(exclusive["timing_repeats"].to_list()) >= 1
    if Path("/proc/self/clear_refs").exists():
        assert exclusive["peak_memory_mb"].null_count() == 0
        assert max(exclusive["peak_memory_mb"].to_list()) > 0
    counting = Counting()
    run(views, FEW, tmp_path / "r", timing="exclusive", engine=InlineEngine(), progress=counting)
    assert counting.rows == 0


@pytest.mark.parametrize(
    "limits",
    [{"workers": -1}, {"workers": 0}, {"timeout": 0}, {"timeout": "soon"}, {"memory_limit": 0}],
)
def test_limits_must_be_positive(views: Dataset, tmp_path: Path, limits: dict[str, Any]) -> None:
    with pytest.raises(ArgumentError, match=next(iter(limits))):
        run(views, FEW, tmp_path / "r", **limits)
    assert not (tmp_path / "r").exists()


def test_every_stage_is_timed(views: Dataset, tmp_path: Path) -> None:
    table = run(views, FEW, tmp_path / "r", timing="exclusive", engine=InlineEngine()).table()
    for column in COLUMNS:
        if column.unit == "s":
            assert table[column.name].null_count() == 0, column.name
            assert min(table[column.name].to_list()) >= 0, column.name
    first = table.row(0, named=True)
    expected = (
        (first["detect_seconds_1"] + first["detect_seconds_2"]) / 2
        + (first["describe_seconds_1"] + first["describe_seconds_2"]) / 2
        + first["match_seconds"]
        + first["verify_seconds"]
    )
    assert first["total_seconds"] == pytest.approx(expected)


@pytest.mark.slow
def test_plug_ins_run_end_to_end(
    views: Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    site = tmp_path / "site"
    write_distribution(site, "feature-arena", ENTRY_POINTS, CODE, version="0.3")
    monkeypatch.syspath_prepend(site)
    for name in [name for name in sys.modules if name.split(".")[0] == "arena"]:
        monkeypatch.delitem(sys.modules, name)
    results = run(
        views,
        "CORNERS-PATCHES-L2-MUTUAL,CORNERS-ORB-HAM-BF,CORNER_BITS-CORNER_BITS-HAM-*,"
        "SIFT-PATCHES-L2-FLANN,CORNER_BITS-SIFT-L2-MUTUAL",
        tmp_path / "r",
        workers=1,
        timeout=60,
    )
    table = results.table()
    assert len(table) == 6 * 3
    for row in table.to_dicts():
        assert row["status"] == "ok", (row["detector"], row["message"])
    of = {row["descriptor"]: row for row in table.to_dicts() if row["detector"] == "CORNERS"}
    parameters = json.loads(of["PATCHES"]["parameters"])
    assert parameters["detector"] == ["feature-arena 0.3", "arena.methods:Corners", {"step": 1}]
    with pytest.raises(SelectionError, match="package_that_nobody_has"):
        run(views, "NEEDY-ORB-HAM-BF", tmp_path / "r", engine=InlineEngine())


def test_a_limit_and_a_preset_are_part_of_a_measurement(tmp_path: Path) -> None:
    dataset = write_dataset(tmp_path / "images", strip(2))
    names = "ORB-ORB-HAM-BF,FAST-BRIEF-HAM-BF"
    results = tmp_path / "results"
    engine = InlineEngine()
    free = rows_of(run(dataset, names, results, engine=engine).table())
    limit: dict[str, Any] = {"max_keypoints": 200, "spread": True}
    table = run(dataset, names, results, engine=engine, **limit).table()
    for row in table.to_dicts():
        assert row["keypoints_1"] <= 200
        assert (row["max_keypoints"], row["keypoint_choice"]) == (200, "spread")
        assert row["inlier_threshold"] == 3.0
    assert not set(table["row_key"]) & {str(row["row_key"]) for row in free.values()}
    for kept in (limit, {}):
        ((_, plan),) = plan_run(dataset, names, results, **kept)
        assert not plan.units

    strict = Preset("strict", "strict", True, thresholds={"ORB-ORB": 0.5})
    table = run(dataset, names, results, preset=strict, engine=engine).table()
    thresholds = dict(zip(table["detector"], table["inlier_threshold"], strict=True))
    assert thresholds == {"ORB": 0.5, "FAST": 3.0}
    inliers = dict(zip(table["detector"], table["inliers"], strict=True))
    before = {str(row["detector"]): row["inliers"] for row in free.values()}
    assert inliers["FAST"] == before["FAST"]
    assert inliers["ORB"] < before["ORB"]
