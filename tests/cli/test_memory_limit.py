"""Under a limit of memory a command ends well, or with one line."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path

import pytest

from aerocues.cli import memory_limit
from tests.waiting import wait_until

resource = pytest.importorskip("resource")
GIGABYTE = 10**9


def start(limit: float, *words: object, least: int = memory_limit.LEAST) -> subprocess.Popen[str]:
    """Start a command that may take so many gigabytes."""
    size = int(limit * GIGABYTE)
    code = (
        f"import resource; resource.setrlimit(resource.RLIMIT_AS, ({size}, {size}))\n"
        f"from aerocues.cli import main, memory_limit; memory_limit.LEAST = {least}; main()"
    )
    return subprocess.Popen(
        [sys.executable, "-c", code, *map(str, words)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


@pytest.mark.parametrize("limit", [0.15, 1.0, 2.9])
def test_too_little_memory_is_told_at_once(limit: float) -> None:
    process = start(limit, "methods", "list")
    out, err = process.communicate()
    assert process.returncode == 2
    assert out == ""
    assert len(err.splitlines()) == 1
    assert err.startswith("error: ")


def test_last_words_of_libraries_become_one_line(photos: Path, tmp_path: Path) -> None:
    """As under a larger limit, which larger images may reach."""
    process = start(0.3, "run", photos, "-o", tmp_path / "out", least=0)
    _, err = process.communicate()
    assert process.returncode == 2
    assert len(err.splitlines()) == 1
    assert err.startswith("error: ")


@pytest.mark.slow
def test_enough_memory_is_enough(photos: Path, tmp_path: Path) -> None:
    words = ("run", photos, "-o", tmp_path / "out", "--combinations", "ORB-ORB-HAM-BF")
    process = start(16, *words, "--workers", 1, "--timing", "shared")
    out, err = process.communicate()
    assert process.returncode == 0, err
    assert "ORB-ORB-HAM-BF" in out


@pytest.mark.slow
def test_a_signal_reaches_the_work(photos: Path, tmp_path: Path) -> None:
    process = start(16, "run", photos, "-o", tmp_path / "out", "--workers", 1)
    wait_until(lambda: any((tmp_path / "out" / "parts").glob("*.parquet")))
    process.send_signal(signal.SIGTERM)
    _, err = process.communicate()
    assert process.returncode == 128 + signal.SIGTERM
    assert err.splitlines()[-1].startswith("interrupted")
