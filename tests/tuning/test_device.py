from __future__ import annotations

import json
from pathlib import Path

import polars as pl
import pytest

import aerocues
from aerocues.errors import ScoreError, SelectionError
from aerocues.scoring.platforms import device_factors
from aerocues.tuning.device import Device, as_device
from tests.cli.other_machine import SLOWER, slower_copy


def test_times_are_scaled_stage_by_stage_and_what_follows_from_them() -> None:
    row: dict[str, object] = {
        "detector": "ORB", "descriptor": "BRIEF", "norm": "HAM", "matcher": "BF",
        "keypoints_1": 100, "keypoints_2": 100, "matches": 50, "inliers": 25,
        "chance_inliers": 5.0, "detect_seconds_1": 1.0, "detect_seconds_2": 3.0,
        "describe_seconds_1": 0.5, "describe_seconds_2": 0.5, "match_seconds": 4.0,
        "verify_seconds": None,
    }  # fmt: skip
    names = [name for name in row if name.endswith("seconds") or "_seconds_" in name]
    row.update({f"{name}_cpu": row[name] for name in names})
    factors = {
        "detect": {"*": 10.0, "ORB": 2.0},
        "describe": {"*": 3.0, "SIFT": 9.0},
        "match": {"*": 1.0, "HAM-BF": 5.0},
        "verify": {"*": 2.0},
    }
    there = Device("board", factors).there(row)
    assert (there["detect_seconds_1"], there["detect_seconds_2_cpu"]) == (2.0, 6.0)
    assert there["describe_seconds_1"] == 1.5
    assert there["match_seconds"] == 20.0
    assert there["verify_seconds"] is None
    assert row["match_seconds"] == 4.0
    verified = Device("board", factors).there({**row, "verify_seconds": 1.0})
    assert verified["total_seconds"] == pytest.approx(4.0 + 1.5 + 20.0 + 2.0)
    assert verified["seconds_per_1k_inliers"] == pytest.approx(1000 * 27.5 / 25)


def test_factors_come_from_the_same_rows_on_two_machines(finished: Path, tmp_path: Path) -> None:
    here = aerocues.Results(finished).table()
    there = aerocues.Results(slower_copy(finished, tmp_path / "board")).table()
    factors = device_factors(here, there)
    assert set(factors) == {"detect", "describe", "match", "verify"}
    assert set(factors["detect"]) == {"*", "ORB", "AKAZE", "GFTT"}
    assert set(factors["match"]) == {"*", "HAM-BF", "HAM-FLANN"}
    for stage in factors.values():
        assert list(stage.values()) == pytest.approx([SLOWER] * len(stage))
    with pytest.raises(ScoreError, match="detect"):
        device_factors(here, there.clear())
    totals_alone = there.with_columns(match_seconds=pl.lit(None, pl.Float64))
    with pytest.raises(ScoreError, match="match"):
        device_factors(here, totals_alone)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("{", "factors.json"),
        ("[]", "'stages' with detect, describe, match, verify"),
        ('{"stages": {"detect": {"*": 0}}}', "positive"),
    ],
)
def test_files_that_hold_no_factors_are_told(tmp_path: Path, content: str, words: str) -> None:
    file = tmp_path / "factors.json"
    file.write_text(content)
    with pytest.raises(SelectionError, match=words):
        as_device(file)
    with pytest.raises(SelectionError, match=r"missing\.json"):
        as_device(tmp_path / "missing.json")
    stages = {name: {"*": 2} for name in ("detect", "describe", "match", "verify")}
    file.write_text(json.dumps({"machine": "board", "stages": stages}))
    assert as_device(file) == Device("board", stages)
