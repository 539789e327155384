"""The light install: what measures, packs, scores and compares does without the heavy packages.

The commands run in the Python of a light install, which ``AEROCUES_LIGHT_PYTHON`` names;
`make test-light` makes one.
"""

from __future__ import annotations

import os
import subprocess
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest

from aerocues.results.measured_results import Results
from tests.cli.conftest import Call

LIGHT_PYTHON = os.environ.get("AEROCUES_LIGHT_PYTHON", "")
pytestmark = pytest.mark.skipif(not LIGHT_PYTHON, reason="needs a light install: make test-light")
COMBINATIONS = "ORB-ORB-HAM-*,SIFT-SIFT-L2-*"

Light = Callable[..., subprocess.CompletedProcess[str]]


@pytest.fixture(scope="module")
def light(tmp_path_factory: pytest.TempPathFactory) -> Light:
    """Call the command line of the light install."""
    folder = tmp_path_factory.mktemp("light")
    environment = {**os.environ, "PYTHONPATH": "", "NO_COLOR": "1", "COLUMNS": "120"}

    def call(*words: object) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [LIGHT_PYTHON, "-m", "aerocues", *map(str, words)],
            cwd=folder,
            env=environment,
            capture_output=True,
            text=True,
            check=False,
        )

    return call


@dataclass(frozen=True)
class Board:
    """What a board measured: its results folder and the file to take home."""

    folder: Path
    packed: Path


@pytest.fixture(scope="module")
def board(light: Light, photos: Path, tmp_path_factory: pytest.TempPathFactory) -> Board:
    folder = tmp_path_factory.mktemp("board")
    made = Board(folder / "results", folder / "board.zip")
    words = ("-o", made.folder, "--combinations", COMBINATIONS, "--timing", "exclusive")
    measured = light("run", photos, *words)
    assert measured.returncode == 0, measured.stderr
    assert "SIFT-SIFT-L2-FLANN" in measured.stdout
    packed = light("results", made.folder, "--pack", made.packed)
    assert packed.returncode == 0, packed.stderr
    return made


def test_the_heavy_packages_are_out_of_reach(light: Light) -> None:
    refused = light("methods", "why", "ORB-ORB-HAM-EXACT")
    assert "numba" in refused.stdout


def test_a_board_measures_and_the_rest_of_the_world_compares(
    call: Call, board: Board, photos: Path, tmp_path: Path
) -> None:
    table = Results(board.packed).table()
    assert len(table) == 12
    assert set(table["status"]) == {"ok"}
    assert set(table["timing"]) == {"exclusive"}
    home, factors = tmp_path / "home", tmp_path / "board.json"
    words = ("-o", home, "--combinations", COMBINATIONS, "--workers", 1)
    assert call("run", photos, *words).code == 0
    compared = call("compare", home, board.packed)
    assert compared.code == 0
    assert "SIFT-SIFT-L2-FLANN" in compared.out
    assert call("compare", home, board.packed, "--factors", factors).code == 0
    assert factors.is_file()


def test_the_rows_are_those_of_a_full_install(call: Call, board: Board, photos: Path) -> None:
    again = call("run", photos, "-o", board.folder, "--combinations", COMBINATIONS)
    assert again.code == 0
    assert "all 12 rows" in again.err


@pytest.mark.parametrize(
    "command",
    [
        "status {0}",
        "results {0} --latex -",
        "score {0}",
        "validate {0}",
        "compare {0} {1}",
        "report {0} --format markdown",
        "methods",
        "methods list",
        "datasets",
        "run --dry-run {2} -o {0}",
    ],
)
def test_what_reads_results_works_on_the_board(
    light: Light, board: Board, photos: Path, command: str
) -> None:
    words = command.format(board.folder, board.packed, photos).split()
    done = light(*words)
    assert done.returncode == 0, done.stderr
    assert done.stdout


@pytest.mark.parametrize(
    ("command", "needed"),
    [
        ("run {2} -o other --combinations ORB-ORB-HAM-EXACT", "numba"),
        ("run {2} -o other --combinations ORB-ORB-HAM-BF --timing estimated", "numba"),
        ("recommend {2} -o other", "numba"),
        ("simulate -o flight --survey mini", "numba"),
        ("report {0} -o page.html", "plotly"),
        ("reconstruct {2} -o models --from {0}", "pycolmap"),
    ],
)
def test_what_needs_more_says_so_in_one_line(
    light: Light, board: Board, photos: Path, command: str, needed: str
) -> None:
    done = light(*command.format(board.folder, board.packed, photos).split())
    assert done.returncode == 2
    assert done.stderr.splitlines()[-1].startswith("error: ")
    assert "Traceback" not in done.stderr
    assert f"pip install {needed}" in done.stderr
