"""The notebooks in `examples/` run, and hold what they give."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

EXAMPLES = Path(__file__).parents[1] / "examples"
NOTEBOOKS = sorted(EXAMPLES.glob("*.ipynb"))


def code_of(notebook: dict[str, Any]) -> list[dict[str, Any]]:
    return [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]


def kinds(cell: dict[str, Any]) -> list[list[str]]:
    """What the outputs of a cell are: names of streams, and forms of values."""
    return [sorted(output.get("data", [output.get("name")])) for output in cell["outputs"]]


def test_there_are_two() -> None:
    assert [file.stem for file in NOTEBOOKS] == ["my_descriptor", "my_photos"]


@pytest.mark.slow
@pytest.mark.timeout(600)
@pytest.mark.parametrize("file", NOTEBOOKS, ids=lambda file: file.stem)
def test_a_notebook_gives_what_it_shows(file: Path, tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, str(EXAMPLES / "execute.py"), str(file), "again.ipynb"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    stored, again = (
        json.loads(path.read_text(encoding="utf-8")) for path in (file, tmp_path / "again.ipynb")
    )
    for number, (shown, new) in enumerate(zip(code_of(stored), code_of(again), strict=True), 1):
        assert shown["execution_count"] == number
        assert kinds(shown) == kinds(new), "".join(shown["source"])
        for before, after in zip(shown["outputs"], new["outputs"], strict=True):
            if "image/jpeg" in before.get("data", {}):  # counts, which no machine changes
                assert before["data"]["text/plain"] == after["data"]["text/plain"]
