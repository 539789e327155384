"""What a race found, in the payload."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from aerocues import Results
from aerocues.report.race import race_facts
from aerocues.tuning.journal import Journal, record_answer, recorded_answer
from tests.report.made_up import folder_of, measured
from tests.report.small_payload import RACE

ANSWER = {**RACE, "dataset": "flight"}


def test_results_without_a_race_have_no_answer(flight: Results) -> None:
    assert race_facts(flight, "flight") is None


def test_a_race_that_was_not_finished_says_so(tmp_path: Path) -> None:
    results = folder_of(measured(), tmp_path)
    Journal(results.folder / "race.json", "key", 60.0).interrupt(3.0)
    assert race_facts(results, "flight") == {"unfinished": True}


def test_the_answer_of_the_latest_race_is_kept_beside_its_steps(tmp_path: Path) -> None:
    results = folder_of(measured(), tmp_path)
    record_answer(results.folder, ANSWER)
    journal = Journal.read(results.folder, "key", 60.0)
    journal.add(["a"], 1.0, 0.0, [])
    assert recorded_answer(results.folder) == ANSWER
    assert race_facts(results, "flight") == ANSWER
    assert race_facts(results, "another") is None
    assert len(Journal.read(results.folder, "key", 60.0).steps) == 1


@pytest.mark.parametrize(
    "answer",
    [
        3,
        {"best": "SIFT-SIFT-L2-EXACT"},
        {name: value for name, value in ANSWER.items() if name != "dataset"},
        {name: value for name, value in ANSWER.items() if name != "ranked"},
        {**ANSWER, "ranked": []},
        {**ANSWER, "ranked": [{"combination": 3}]},
        {**ANSWER, "best": None},
        {**ANSWER, "pairs": "8"},
        {**ANSWER, "final": {"images": 30, "of": 300}},
        {**ANSWER, "final": {"images": 30, "of": 300, "models": [3], "unfinished": []}},
    ],
)
def test_a_damaged_race_has_no_answer(tmp_path: Path, answer: object) -> None:
    (tmp_path / "race.json").write_text(json.dumps({"answer": answer}))
    assert recorded_answer(tmp_path) is None


def test_a_report_of_a_damaged_race_says_that_it_has_no_answer(tmp_path: Path) -> None:
    results = folder_of(measured(), tmp_path)
    (results.folder / "race.json").write_text(json.dumps({"answer": {"best": "SIFT"}}))
    assert race_facts(results, "flight") == {"unfinished": True}
