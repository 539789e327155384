"""Ctrl-C and the signals that end a process: what is stored stays, no worker is left behind."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
from pathlib import Path

import psutil
import pytest

from aerocues.results.measured_results import Results
from tests.waiting import wait_until

# A shell that starts tests in the background makes them ignore SIGINT, and children inherit that.
PROGRAM = (
    "import signal; signal.signal(signal.SIGINT, signal.default_int_handler); "
    "from aerocues.cli import main; main()"
)
COMBINATIONS = "*-BRIEF-HAM-BF,*-SIFT-L2-BF,!TBMR-*,!MSD-*,!HL-*"
ROWS = 3 * (11 + 11)


def begin(photos: Path, output: Path) -> subprocess.Popen[str]:
    words = ["run", str(photos), "-o", str(output), "--combinations", COMBINATIONS]
    words += ["--timing", "shared", "--workers", "1"]
    return subprocess.Popen(
        [sys.executable, "-c", PROGRAM, *words],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


@pytest.mark.slow
@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_an_interrupted_run_says_so_and_goes_on(
    photos: Path, tmp_path: Path, number: signal.Signals, code: int
) -> None:
    output = tmp_path / "results"
    process = begin(photos, output)
    wait_until(lambda: process.poll() is not None or list(output.glob("parts/*.parquet")))
    workers = psutil.Process(process.pid).children(recursive=True)
    process.send_signal(number)
    out, err = process.communicate()
    assert process.returncode == code, err
    assert out == ""
    _, alive = psutil.wait_procs(workers, timeout=60)
    assert workers
    assert alive == []

    stored = len(Results(output).table())
    assert 0 < stored < ROWS
    last_line = err.splitlines()[-1]
    assert re.match(rf"interrupted; {stored} (of [\d,]+ )?rows are ", last_line)
    assert "Traceback" not in err

    again = begin(photos, output)
    out, err = again.communicate()
    assert again.returncode == 0, err
    assert f"{stored} rows" in err
    status = Results(output).status()
    assert (status.done, status.left) == (ROWS, 0)


@pytest.mark.slow
def test_a_worker_that_is_just_starting_is_not_left_behind(photos: Path, tmp_path: Path) -> None:
    process = begin(photos, tmp_path / "results")
    parent = psutil.Process(process.pid)
    wait_until(lambda: process.poll() is not None or parent.children(recursive=True))
    workers = parent.children(recursive=True)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate()
    assert process.returncode == 130, err
    assert "Traceback" not in err
    _, alive = psutil.wait_procs(workers, timeout=60)
    assert alive == []
