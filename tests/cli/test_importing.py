"""`aerocues import`: tables made elsewhere, and what comes back from our own."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from polars.testing import assert_frame_equal

from aerocues.results.measured_results import Results
from tests.cli.conftest import Call
from tests.evaluation.tables import figures, measured, write_table
from tests.waiting import wait_until


def test_folders_are_listed_with_what_they_hold(call: Call, tmp_path: Path) -> None:
    file = write_table(tmp_path / "t.csv", measured("a", "b") + measured("a", "c", 3))
    models = write_table(tmp_path / "models.csv", figures("a"))
    answer = call("import", file, "-o", tmp_path / "out", "--reconstruction", models)
    assert answer.code == 0, answer.err
    heading, *lines = (line.split() for line in answer.out.splitlines())
    assert heading == ["results", "folder", "rows", "combinations", "pairs", "reconstructions"]
    assert lines == [
        [str(tmp_path / "out" / "a-b"), "4", "2", "2", "2"],
        [str(tmp_path / "out" / "a-c"), "6", "2", "3", "2"],
    ]


def test_what_is_imported_is_read_by_the_other_commands(call: Call, tmp_path: Path) -> None:
    file = write_table(tmp_path / "t.parquet", measured("a", "b") + measured("a", "c"))
    folder = tmp_path / "out"
    words = ("import", file, "-o", folder, "--dataset", "a", "--platform", "c")
    assert call(*words).code == 0
    status = call("status", folder).out
    assert status.startswith("4 of 4 rows done, none left\n")
    summary = call("results", folder).out
    assert "4 rows of 2 combinations" in summary
    assert "t.parquet" in summary
    assert "None" not in summary


def test_measured_rows_come_back(call: Call, finished: Path, tmp_path: Path) -> None:
    file = tmp_path / "rows.csv"
    assert call("results", finished, "--csv", file).code == 0
    assert call("import", file, "-o", tmp_path / "again").code == 0
    assert_frame_equal(Results(tmp_path / "again").table(), Results(finished).table())


def test_mistakes_are_told_in_one_line(call: Call, finished: Path, tmp_path: Path) -> None:
    table = write_table(tmp_path / "t.csv", measured("a", "b"))
    wrong = write_table(tmp_path / "wrong.csv", [{"dataset": "a", "colour": "red"}])
    for file, output, told in (
        (tmp_path / "none.csv", tmp_path / "out", "No such file"),
        (tmp_path, tmp_path / "out", "Is a directory"),
        (wrong, tmp_path / "out", "colour"),
        (table, finished, str(finished)),
        (table, table, str(table)),
    ):
        answer = call("import", file, "-o", output)
        assert answer.code == 2
        assert re.fullmatch(rf"error: .*{re.escape(told)}.*\n", answer.err)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupted_import_leaves_nothing(tmp_path: Path, number: signal.Signals) -> None:
    file = write_table(tmp_path / "t.csv", measured("a", "b"))
    waiting = tmp_path / "waiting"
    program = (
        "import os, pathlib, time\n"
        "from aerocues.cli import main\n"
        f"def wait(_): pathlib.Path({str(waiting)!r}).touch(); time.sleep(60)\n"
        "os.fsync = wait\n"
        f"main(['import', {str(file)!r}, '-o', {str(tmp_path / 'out')!r}])\n"
    )
    with subprocess.Popen([sys.executable, "-c", program], stderr=subprocess.PIPE) as process:
        wait_until(lambda: process.poll() is not None or waiting.exists())
        process.send_signal(number)
        assert process.stderr is not None
        assert process.stderr.read() == b"interrupted\n"
    assert process.returncode == 128 + number
    assert sorted(tmp_path.iterdir()) == [file, waiting]
