"""`aerocues recommend --from` and `aerocues score --objective`."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import polars as pl
import pytest

from aerocues.cli.choice_table import print_choice
from aerocues.scoring.objectives import OBJECTIVES
from aerocues.tuning.choice import choose
from tests.cli.conftest import Call
from tests.scoring.measurements import Stored, row, rows


def test_finished_results_answer_at_once(call: Call, finished: Path) -> None:
    answer = call("recommend", "--from", finished, "--objective", "speed", "--top", 2)
    assert answer.code == 0
    assert max(map(len, answer.out.splitlines())) <= 100
    facts = json.loads(call("recommend", "--from", finished, "--objective", "speed", "--json").out)
    assert answer.out.startswith(f"Take {facts['best']}.")
    assert len(facts["ranking"]) == 4
    assert (facts["objective"], facts["presets"]) == ("speed", ["default"])
    assert "best 2 of 4" in answer.out


def test_limits_are_told(call: Call, finished: Path) -> None:
    answer = call("recommend", "--from", finished, "--max-descriptor-bytes", 40)
    assert answer.code == 0
    # FREAK has 64 bytes, AKAZE 61.
    assert "Left out: 2 (size of a descriptor)." in answer.out


def test_score_ranks_for_a_purpose(call: Call, finished: Path, tmp_path: Path) -> None:
    file = tmp_path / "ranking.csv"
    answer = call("score", finished, "--objective", "accuracy", "--csv", file, "--resamples", 20)
    assert answer.code == 0
    assert "objective accuracy" in answer.out
    frame = pl.read_csv(file)
    assert frame["combination"].n_unique() == 4
    assert frame["score"].is_sorted(descending=True)
    limited = call("score", finished, "--max-descriptor-bytes", 40, "--json").out
    assert len(json.loads(limited)["ranking"]) == 2


@pytest.mark.parametrize(
    "words",
    [
        ["recommend"],
        ["recommend", "photos", "--max-memory", "300MB"],
        ["recommend", "photos", "--json"],
        ["recommend", "photos", "--from", "RESULTS"],
        ["recommend", "--from", "RESULTS", "--budget", "5min"],
        ["recommend", "--from", "RESULTS", "--no-final"],
        ["recommend", "--from", "RESULTS", "--max-memory", "much"],
        ["recommend", "--from", "nowhere"],
        ["recommend", "--from", "RESULTS", "--from", "RESULTS"],
        ["recommend", "--from", "RESULTS", "--combinations", "NOPE"],
        ["score", "RESULTS", "--objective", "speed", "--preset", "thesis"],
        ["score", "RESULTS", "--objective", "speed", "--interval", "joint"],
        ["score", "RESULTS", "--licence", "permissive", "--test", "bootstrap"],
        ["score", "RESULTS", "--max-descriptor-bytes", "40", "--top-k", "3"],
    ],
)
def test_what_makes_no_sense_is_refused(call: Call, finished: Path, words: list[str]) -> None:
    answer = call(*(str(finished) if word == "RESULTS" else word for word in words))
    assert answer.code == 2
    assert answer.err.startswith("error: ")


def test_every_objective_can_be_asked_for() -> None:
    from aerocues.cli.limit_options import Objective

    assert [each.value for each in Objective] == list(OBJECTIVES)


def test_medians_are_told_of_where_there_are_seconds(capsys: pytest.CaptureFixture[str]) -> None:
    table = rows(
        *(row(name, pair) for name in ("ORB-ORB-HAM-BF", "SIFT-SIFT-L2-BF") for pair in range(3))
    )
    found = choose(Stored(table), "accuracy", resamples=2)
    print_choice(found, 5)
    assert "seconds are medians" in capsys.readouterr().out
    without = found.ranked.with_columns(total_seconds=pl.lit(None, pl.Float64))
    print_choice(replace(found, ranked=without), 5)
    assert "medians" not in capsys.readouterr().out
