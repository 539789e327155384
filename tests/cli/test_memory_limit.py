"""Under a limit of memory a command ends well, or with one line."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path

import pytest

from tests.waiting import wait_until

resource = pytest.importorskip("resource")
pytestmark = pytest.mark.slow
GIGABYTE = 10**9


def start(limit: float, *words: object) -> subprocess.Popen[str]:
    """Start a command that may take so many gigabytes."""
    size = int(limit * GIGABYTE)
    code = (
        f"import resource; resource.setrlimit(resource.RLIMIT_AS, ({size}, {size}))\n"
        "from aerocues.cli import main; main()"
    )
    return subprocess.Popen(
        [sys.executable, "-c", code, *map(str, words)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


@pytest.mark.parametrize("limit", [0.15, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 1.0, 1.3, 1.6, 2.0, 2.3])
def test_too_little_memory_is_told_in_one_line(limit: float, photos: Path, tmp_path: Path) -> None:
    words = ("run", photos, "-o", tmp_path / "out", "--combinations", "ORB-ORB-HAM-BF")
    process = start(limit, *words, "--workers", 2, "--timing", "shared")
    _, err = process.communicate()
    assert "Traceback" not in err
    if process.returncode:
        assert process.returncode == 2
        [line] = [line for line in err.splitlines() if line.startswith("error: ")]
        assert err.endswith(f"{line}\n")


def test_enough_memory_is_enough(photos: Path, tmp_path: Path) -> None:
    words = ("run", photos, "-o", tmp_path / "out", "--combinations", "ORB-ORB-HAM-BF")
    process = start(16, *words, "--workers", 1, "--timing", "shared")
    out, err = process.communicate()
    assert process.returncode == 0, err
    assert "ORB-ORB-HAM-BF" in out


def test_a_signal_reaches_the_work(photos: Path, tmp_path: Path) -> None:
    process = start(16, "run", photos, "-o", tmp_path / "out", "--workers", 1)
    wait_until(lambda: any((tmp_path / "out" / "parts").glob("*.parquet")))
    process.send_signal(signal.SIGTERM)
    _, err = process.communicate()
    assert process.returncode == 128 + signal.SIGTERM
    assert err.splitlines()[-1].startswith("interrupted")
