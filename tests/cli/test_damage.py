"""A run heals a damaged folder, and removes what a killed run left."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from polars.testing import assert_frame_equal

from aerocues.results.measured_results import Results
from tests.cli.conftest import COMBINATIONS, Call
from tests.waiting import wait_until

MEASURED = ("pair", "detector", "descriptor", "matcher", "status", "matches", "inliers", "recall")


@pytest.mark.slow
def test_the_same_run_measures_again_what_was_damaged(
    call: Call, finished: Path, photos: Path, tmp_path: Path
) -> None:
    folder = tmp_path / "results"
    shutil.copytree(finished, folder)
    whole = Results(folder).table()
    part = min((folder / "parts").glob("*.parquet"))
    part.write_bytes(b"")
    (folder / "parts" / f"._{part.name}").write_bytes(b"\0\5\26\7")
    answer = call("run", photos, "-o", folder, "--combinations", COMBINATIONS, "--workers", 1)
    assert answer.code == 0, answer.err
    [warning] = [line for line in answer.err.splitlines() if line.startswith("warning: ")]
    assert str(part) in warning
    assert (folder / "damaged" / part.name).read_bytes() == b""
    assert_frame_equal(Results(folder).table().select(MEASURED), whole.select(MEASURED))
    assert call("status", folder, "--verify").out.endswith("files checked, none damaged\n")


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="kills a group of processes")
def test_the_next_run_removes_what_a_killed_one_left(
    photos: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    words = [sys.executable, "-m", "aerocues", "run", str(photos), "-o", str(tmp_path / "out")]
    killed = subprocess.Popen(
        [*words, "--workers", "1"], process_group=0, stderr=subprocess.DEVNULL
    )
    wait_until(lambda: any(tmp_path.glob("out/parts/*.parquet")))
    [left] = tmp_path.glob("aerocues-worker-*")
    os.killpg(killed.pid, signal.SIGKILL)
    killed.wait()
    assert left.exists()
    few = ["--combinations", "ORB-ORB-HAM-BF", "--timing", "shared", "--workers", "1"]
    subprocess.run([*words, *few], check=True, capture_output=True)
    assert not list(tmp_path.glob("aerocues-worker-*"))
