"""Thresholds that a run lowers until detectors find the number of keypoints that is kept."""

from __future__ import annotations

import functools
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from aerocues.datasets.dataset import Dataset
from aerocues.errors import ArgumentError
from aerocues.evaluation import run as running
from aerocues.methods.preset_files import recorded_preset
from aerocues.progress import Event
from tests.evaluation.inline import InlineEngine
from tests.evaluation.scenes import strip, write_dataset

run = functools.partial(running.run, timing="shared")
SIFT, KAZE = "SIFT-SIFT-L2-BF", "KAZE-KAZE-L2-BF"
WANTED = 300


def contrast_of(row: dict[str, Any]) -> float:
    return float(json.loads(row["parameters"])["detector"][-1]["contrastThreshold"])


@pytest.fixture
def faint(tmp_path: Path) -> Dataset:
    """A pair of low contrast, in which thresholds matter."""
    images = {
        name: (110 + 0.12 * (image.astype(np.float64) - 110)).astype(np.uint8)
        for name, image in strip(2).items()
    }
    return write_dataset(tmp_path / "images", images)


def test_thresholds_are_lowered_where_that_is_asked_for(faint: Dataset, tmp_path: Path) -> None:
    found = {}
    for name, asked in {"usual": None, "lowered": True}.items():
        results = run(
            *(faint, SIFT, tmp_path / name),
            max_keypoints=WANTED,
            equal_footing=asked,
            engine=InlineEngine(),
        )
        [found[name]] = results.table().to_dicts()
    usual, lowered = found["usual"], found["lowered"]
    assert contrast_of(usual) == 0.04
    assert contrast_of(lowered) < 0.04
    assert usual["keypoints_1"] < WANTED <= lowered["keypoints_1"] + 10
    assert (usual["preset"], lowered["preset"]) == ("default", f"default-{WANTED}")


def test_tuned_reaches_the_number_unless_it_is_told_not_to(faint: Dataset, tmp_path: Path) -> None:
    for asked, preset in ((None, f"tuned-{WANTED}"), (False, "tuned")):
        results = run(
            *(faint, SIFT, tmp_path / preset),
            preset="tuned",
            max_keypoints=WANTED,
            equal_footing=asked,
            engine=InlineEngine(),
        )
        assert results.table()["preset"].unique().to_list() == [preset]
    all_of_them = run(faint, SIFT, tmp_path / "all", preset="tuned", engine=InlineEngine())
    assert all_of_them.table()["preset"].unique().to_list() == ["tuned"]


def test_another_run_keeps_the_thresholds_of_the_first(faint: Dataset, tmp_path: Path) -> None:
    told: list[Event] = []
    options: dict[str, Any] = {"preset": "tuned", "max_keypoints": WANTED, "engine": InlineEngine()}
    run(faint, SIFT, tmp_path / "r", **options)
    results = run(faint, KAZE, tmp_path / "r", **options)
    lowered = recorded_preset(results.settings).detectors
    assert float(lowered["SIFT"]["contrastThreshold"]) < 0.04
    assert set(results.table()["detector"]) == {"KAZE", "SIFT"}
    both = run(faint, f"{SIFT},{KAZE}", tmp_path / "r", **options, progress=told.append)
    assert len(both.table()) == 2
    assert not any(event.rows for event in told), "nothing is left to measure"
    plan = running.plan_run(
        *(faint, f"{SIFT},{KAZE}", tmp_path / "r"),
        **{name: options[name] for name in ("preset", "max_keypoints")},
        timing="shared",
    )
    assert plan[0][1].rows_left == 0


@pytest.mark.parametrize(
    "wrong",
    [{"equal_footing": True}, {"equal_footing": True, "max_keypoints": 9, "preset": "thesis"}],
)
def test_there_must_be_a_number_to_reach(
    wrong: dict[str, Any], faint: Dataset, tmp_path: Path
) -> None:
    with pytest.raises(ArgumentError):
        run(faint, SIFT, tmp_path / "r", **wrong)
    assert not (tmp_path / "r").exists()
