"""`aerocues study`, and other commands on its parts."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from aerocues.results.study import add_part
from tests.cli.conftest import Call
from tests.made_once import made_once

PARTS = ("beach-part", "quarry-part")


@pytest.fixture
def database(
    finished: Path, tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch
) -> Path:
    """Two parts with the same rows, at the usual place."""

    def make(folder: Path) -> None:
        for name in PARTS:
            facts = {"title": "views", "licence": "ours", "cpu_hours": 0.1}
            add_part(folder / "study" / "database", name, finished, facts)

    folder = made_once(tmp_path_factory, "study-of-views", make)[0]
    monkeypatch.delenv("AEROCUES_STUDY", raising=False)
    monkeypatch.chdir(folder)
    return folder / "study" / "database"


def test_it_shows_what_is_in_it(database: Path, call: Call) -> None:
    shown = call("study")
    assert shown.code == 0
    assert all(name in shown.out for name in PARTS)
    assert "24 rows and 0 models" in shown.out
    assert call("study", database.parent / "nothing").code == 2


def test_it_answers_queries(database: Path, call: Call) -> None:
    query = "SELECT part, COUNT(*) AS rows FROM results GROUP BY part ORDER BY part"
    assert call("study", "--sql", query).out.split() == [
        "part",
        "rows",
        PARTS[0],
        "12",
        PARTS[1],
        "12",
    ]
    assert (
        call("study", database, "--sql", query, "--csv", "-").out.splitlines()[1] == "beach-part,12"
    )
    answer = json.loads(call("study", "--sql", query, "--json").out)
    assert answer == [{"part": name, "rows": 12} for name in PARTS]
    assert call("study", "--json", "--csv", "-").code == 2
    assert call("study", "--columns", "--sql", query).code == 2
    assert call("study", "--pack", "study.zip", "--json").code == 2


def test_its_columns_are_explained(call: Call) -> None:
    told = call("study", "--columns").out
    assert "licence: terms of the images" in told
    assert "inliers [count]" in told


@pytest.mark.parametrize(
    "words",
    [
        ["score", "study:beach-part", "--resamples", "10"],
        ["recommend", "--from", "study:beach-part", "--from", "study:quarry-part"],
        ["compare", "study:beach-part", "study:quarry-part"],
        ["report", "study:beach-part", "--format", "markdown", "--resamples", "10"],
    ],
    ids=lambda words: words[0],
)
def test_other_commands_take_its_parts(database: Path, words: list[str], call: Call) -> None:
    done = call(*words)
    assert done.code == 0, done.err
    assert "ORB-ORB-HAM-BF" in done.out


def test_it_is_packed_and_opened_elsewhere(database: Path, call: Call) -> None:
    assert call("study", "--pack", database.parent / "study.zip").code == 0
    opened = call("study", database.parent / "study.zip", "--sql", "SELECT part FROM parts")
    assert opened.out.split() == ["part", *PARTS]
