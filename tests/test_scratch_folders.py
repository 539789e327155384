"""Folders of killed processes are removed; those of living ones and of others are not."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from aerocues.scratch_folders import remove_left_over, scratch_prefix


@pytest.fixture(autouse=True)
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    return tmp_path


def ended_process() -> int:
    process = subprocess.Popen([sys.executable, "-c", "pass"])
    process.wait()
    return process.pid


def test_what_killed_processes_left_is_removed(temporary: Path) -> None:
    own, dead = f"-{os.getpid()}-", f"-{ended_process()}-"
    mine = scratch_prefix("worker") + "abc_12"
    left = mine.replace(own, dead)
    kept = (mine, "aerocues-worker-abcdef12", "aerocues-other" + dead + "x", "mine")
    for name in (*kept, left):
        (temporary / name).mkdir()
        (temporary / name / "heartbeat").touch()
    (temporary / scratch_prefix("packed").replace(own, dead)).touch()
    remove_left_over()
    names = {path.name for path in temporary.iterdir()}
    assert {*kept} <= names
    assert left not in names


def test_another_process_of_the_same_number_keeps_nothing(temporary: Path) -> None:
    folder = temporary / (scratch_prefix("worker") + "abc")
    folder.mkdir()
    os.utime(folder, (1000.0, 1000.0))
    remove_left_over()
    assert not folder.exists()
