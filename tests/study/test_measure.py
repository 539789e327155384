"""The program that measures the study, with a tiny configuration."""

from __future__ import annotations

import json
import os
import shutil
import signal
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import polars as pl
import pytest

import aerocues
from aerocues.errors import ArgumentError
from study.flights import make_flight
from study.machines import remove_rows_of_others
from study.measure import main
from study.measuring import Study
from study.plan import CONFIGURATION, read_plan
from study.verify import differing
from tests.cli.conftest import shared_views
from tests.made_once import made_once

pytestmark = pytest.mark.slow

TINY = """
max_megabytes = 1
[defaults.run]
timing = "estimated"
max_keypoints = 300
[[round]]
name = "first"
combinations = "ORB-ORB-HAM-BF,GFTT-BRIEF-HAM-BF"
seconds_per_row = 0.5
[[round]]
name = "second"
combinations = "ORB-ORB-HAM-FLANN"
seconds_per_row = 0.1
[flight.merged]
merge = ["photos"]
[[part]]
name = "views"
title = "views of one picture"
licence = "ours"
dataset = "{flights}/merged"
pairs = 3
[[part]]
name = "elsewhere"
title = "what needs something"
licence = "ours"
dataset = "{data}/photos"
pairs = 3
needs = ["no_such_module"]
[[part]]
name = "nowhere"
title = "images that are not there"
licence = "ours"
dataset = "{data}/nowhere"
pairs = 3
"""


PLACES = ("data", "work", "database")


@dataclass
class Counted:
    """`aerocues.run`, which counts the combinations and keeps how it is asked for them."""

    run: Callable[..., Any]
    rows: int = 0
    equal_footing: bool | None = None

    def __call__(self, dataset: Any, combinations: list[str], *rest: Any, **named: Any) -> Any:
        self.rows += len(combinations)
        self.equal_footing = named.get("equal_footing")
        return self.run(dataset, combinations, *rest, **named)


@pytest.fixture(scope="module")
def measured(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a measured study of two rounds."""

    def make(folder: Path) -> None:
        (folder / "tiny.toml").write_text(TINY)
        shutil.copytree(shared_views(tmp_path_factory), folder / "data" / "photos")
        assert main([*arguments(folder), "--budget", "0.001s"]) == 3
        assert main(arguments(folder)) == 3  # two parts cannot be measured here

    return made_once(tmp_path_factory, "tiny-study", make)[0]


def arguments(folder: Path) -> list[str]:
    """Of the program, for everything in one folder."""
    places = {"configuration": "tiny.toml", "data": "data", "work": "work", "database": "database"}
    words = [word for name, place in places.items() for word in (f"--{name}", str(folder / place))]
    return [*words, "--workers", "1"]


def test_the_database_holds_each_row_once(measured: Path) -> None:
    study = aerocues.Study(measured / "database")
    assert study.names == ("views",)
    rows = study.table()
    assert len(rows) == 9
    assert rows.select("detector", "matcher", "pair").is_unique().all()
    assert rows["part"].unique().to_list() == ["views"]
    parts = study.parts().row(0, named=True)
    assert parts["title"] == "views of one picture"
    assert parts["cpu_hours"] >= 0


def test_nothing_of_this_machine_is_in_it(measured: Path) -> None:
    record = (measured / "database" / "views" / "run.json").read_text()
    assert str(measured) not in record
    assert "source" not in json.loads(record)["dataset"]
    texts = aerocues.Study(measured / "database").table().select(pl.col(pl.String))
    found = [column.name for column in texts if column.str.contains(str(measured.parent)).any()]
    assert found == []


def test_a_finished_study_goes_on_from_its_database_alone(measured: Path, tmp_path: Path) -> None:
    shutil.copytree(measured / "database", tmp_path / "database")
    shutil.copytree(measured / "data", tmp_path / "data")
    (tmp_path / "tiny.toml").write_text(TINY)
    assert main([*arguments(tmp_path), "--only", "views"]) == 0
    assert not (tmp_path / "work").exists()
    more = TINY.replace('"ORB-ORB-HAM-FLANN"', '"ORB-ORB-HAM-*"')
    (tmp_path / "tiny.toml").write_text(more)
    assert main([*arguments(tmp_path), "--only", "views"]) == 0
    assert aerocues.Study(tmp_path / "database").parts()["covered"].to_list() == [9]
    steps = aerocues.Results(tmp_path / "database" / "views").settings["study"]["steps"]
    assert {name: step["rows"] for name, step in steps.items()} == {"first": 6, "second": 3}


def test_rows_of_other_parameters_are_measured_again(measured: Path, tmp_path: Path) -> None:
    for place in PLACES:
        shutil.copytree(measured / place, tmp_path / place)
    preset = tmp_path / "mine.json"
    words, counts = [*arguments(tmp_path), "--only", "views"], []
    changed = TINY.replace("max_keypoints = 300", f'max_keypoints = 300\npreset = "{preset}"')
    (tmp_path / "tiny.toml").write_text(changed)
    for levels in (8, 4):
        preset.write_text(json.dumps({"name": "mine", "detectors": {"ORB": {"nlevels": levels}}}))
        assert main(words) == 0
        rows = aerocues.Study(tmp_path / "database").table()
        orb = rows.filter(pl.col("detector") == "ORB")
        assert orb["parameters"].str.contains(f'"nlevels": {levels}').all()
        counts.append(rows.sort("detector", "matcher", "pair"))
    assert [len(each) for each in counts] == [9, 9]
    same = counts[0]["measured_at"] == counts[1]["measured_at"]
    assert counts[0].filter(same)["detector"].to_list() == ["GFTT"] * 3
    # A round that is not measured yet has no row with other parameters.
    preset.write_text(json.dumps({"name": "mine", "detectors": {"ORB": {"nlevels": 6}}}))
    plan = read_plan(tmp_path / "tiny.toml")
    data, work, database = (tmp_path / place for place in PLACES)
    study = Study(plan, data, work, database, workers=1)
    study.make(plan.of(["views"])[0])
    rows = aerocues.Study(tmp_path / "database").table()
    assert rows["matcher"].unique().to_list() == ["BF"]
    steps = study.steps("views")
    assert {name: bool(step["finished"]) for name, step in steps.items()} == {
        "first": True,
        "second": False,
    }
    assert sum(step["rows"] for step in steps.values()) == len(rows) == 6


def test_rows_of_other_machines_are_measured_again_where_asked_for(
    measured: Path, tmp_path: Path
) -> None:
    for place in ("data", "database"):
        shutil.copytree(measured / place, tmp_path / place)
    (tmp_path / "tiny.toml").write_text(TINY)
    (file,) = (tmp_path / "database" / "views" / "parts").glob("*.parquet")
    rows = pl.read_parquet(file)
    there = pl.when(detector="GFTT").then(pl.lit("another")).otherwise("machine")
    rows.with_columns(there.alias("machine")).write_parquet(file)
    words = [*arguments(tmp_path), "--only", "views"]
    assert main(words) == 0
    study = aerocues.Study(tmp_path / "database")
    assert study.table()["machine"].value_counts().height == 2
    assert main([*words, "--one-machine"]) == 0
    again = study.table()
    assert again["machine"].unique().to_list() == rows["machine"].unique().to_list()
    kept = again.join(rows, on=("row_key", "measured_at"))
    assert (len(again), len(kept)) == (9, 6)
    assert kept["detector"].unique().to_list() == ["ORB"]
    steps = aerocues.Results(tmp_path / "database" / "views").settings["study"]["steps"]
    assert all(step["finished"] for step in steps.values())
    assert not main([*words, "--one-machine"])
    # What is kept may be what was kept before.
    folder = tmp_path / "work" / "views"
    for part in (folder / "parts").glob("GFTT*.parquet"):
        pl.read_parquet(part).with_columns(pl.lit("another").alias("machine")).write_parquet(part)
    assert remove_rows_of_others(folder) == 3
    assert aerocues.Results(folder).table()["detector"].to_list() == ["ORB"] * 6


def test_what_is_asked_for_must_exist(measured: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*arguments(measured), "--dry-run", "--only", "elsewhere"]) == 0
    assert "needs no_such_module" in capsys.readouterr().out
    assert main([*arguments(measured), "--only", "nothing"]) == 2


def test_a_row_that_differs_is_found(measured: Path) -> None:
    rows = aerocues.Study(measured / "database").table()
    assert differing(rows, rows).is_empty()
    other = rows.with_columns(
        pl.when(pl.int_range(pl.len()) == 4).then(-1).otherwise("inliers").alias("inliers")
    )
    assert len(differing(rows, other)) == 1


def test_measured_again_it_is_identical(
    measured: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    shutil.copytree(measured, tmp_path, dirs_exist_ok=True)
    words = [*arguments(tmp_path), "--only", "views"]
    assert main([*words, "--verify"]) == 0
    assert "1 row measured again, 1 identical" in capsys.readouterr().out
    parts = aerocues.Study(tmp_path / "database").parts()
    assert parts.select("again", "identical").row(0) == (1, 1)
    assert parts["title"].to_list() == ["views of one picture"]
    assert {folder.name for folder in (tmp_path / "work").iterdir()} == {"views", "flights"}

    counted = Counted(aerocues.run)
    monkeypatch.setattr(aerocues, "run", counted)
    assert main([*words, "--verify"]) == 0
    assert counted.rows == 1
    assert counted.equal_footing is False  # thresholds as they were measured

    data, work, database = (tmp_path / place for place in PLACES)
    study = Study(read_plan(tmp_path / "tiny.toml"), data, work, database)
    [step, *_] = study.plan.of(["views"])
    study.store(step, 0.0, 0, finished=True)
    assert study.facts("views")["verified"] == {"again": 1, "identical": 1}
    shutil.rmtree(tmp_path / "work" / "views")
    more = [*words[2:], "--configuration", str(tmp_path / "more.toml")]
    (tmp_path / "more.toml").write_text(TINY.replace("HAM-FLANN", "HAM-EXACT"))
    assert main(more) == 0
    assert "verified" not in study.facts("views")


def test_an_interruption_stores_what_there_is(
    measured: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copytree(measured / "data", tmp_path / "data")
    (tmp_path / "tiny.toml").write_text(TINY)
    run = aerocues.run

    def interrupted(*terms: Any, **named: Any) -> None:
        run(*terms, **named)
        os.kill(os.getpid(), signal.SIGTERM)

    monkeypatch.setattr(aerocues, "run", interrupted)
    assert main([*arguments(tmp_path), "--only", "views"]) == 128 + signal.SIGTERM
    parts = aerocues.Study(tmp_path / "database").parts()
    assert parts.select("rows", "covered").row(0) == (6, 6)


def test_an_interrupted_copy_is_made_again(measured: Path, tmp_path: Path) -> None:
    (tmp_path / "photos" / "inner").mkdir(parents=True)
    (tmp_path / "photos" / "a.png").write_bytes(b"all of it")
    (tmp_path / "flight").mkdir()
    (tmp_path / "flight" / "a.png.part").write_bytes(b"all")
    make_flight({"merge": ["photos"]}, tmp_path / "flight", tmp_path)
    [only] = (tmp_path / "flight").iterdir()
    assert only.read_bytes() == b"all of it"


def test_the_configuration_of_the_study_is_sound() -> None:
    plan = read_plan()
    names = list(dict.fromkeys(step.part.name for step in plan.steps))
    assert CONFIGURATION.is_file()
    assert len(names) > 15
    assert plan.steps[0].round is not None
    hours = sum(step.seconds({}) for step in plan.steps if not step.missing()) / 3600
    assert hours < 12


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("pairs = 3", "pears = 3"),
        ("max_megabytes = 1", 'max_megabytes = "x"'),
        ("{data}/nowhere", "{nope}"),
        ("{data}/nowhere", "{data"),
        ("seconds_per_row = 0.5", 'seconds_per_row = "x"'),
    ],
)
def test_what_is_wrong_with_a_configuration_is_told(right: str, wrong: str, tmp_path: Path) -> None:
    file = tmp_path / "wrong.toml"
    file.write_text(TINY.replace(right, wrong))
    with pytest.raises(ArgumentError):
        read_plan(file)


@pytest.mark.parametrize(
    "words",
    [
        ["--engine", "dask"],
        ["--scheduler", "tcp://x:8786"],
        ["--engine", "dask", "--scheduler", "tcp://x:abc"],
    ],
)
def test_an_engine_that_cannot_be_is_refused(words: list[str], measured: Path) -> None:
    assert main([*arguments(measured), *words]) == 2


def test_what_is_finished_stays_finished() -> None:
    hashes = {step.name: step.asked() for step in read_plan().steps if not step.missing()}
    assert hashes["oxford-thesis exact"] == "e006ee2747e2b70bc15b92e30744b094"
