"""The payload's types, which the page's JavaScript is checked by: real payloads have that shape."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from aerocues import Results
from aerocues.report.report import write_report
from tests.report.decoding import payload_in
from tests.report.small_payload import lone_payload, small_payload

COMPILER = Path("node_modules", "typescript", "bin", "tsc")
TYPES = Path("src", "aerocues", "report", "page", "types", "payload.d.ts")


@pytest.fixture(scope="module")
def faults(
    flight: Results, repository: Path, tmp_path_factory: pytest.TempPathFactory
) -> dict[str, list[str]]:
    """What the compiler says of payloads as literals of the type, by their names."""
    folder = tmp_path_factory.mktemp("types")
    wrong = lone_payload()
    wrong["entries"][0]["score"]["best"] = "the first"
    page = write_report(flight, folder / "report.html", resamples=50)
    payloads = {
        "report": payload_in(page),
        "small": small_payload(),
        "lone": lone_payload(),
        "wrong": wrong,
    }
    told = _compiled(repository, payloads, folder)
    return {
        name: [line for line in told.splitlines() if line.startswith(f"{name}.ts")]
        for name in payloads
    }


def _compiled(repository: Path, payloads: dict[str, dict[str, Any]], folder: Path) -> str:
    beside = str(Path(sys.executable).parent)
    node = shutil.which("node", path=beside) or shutil.which("node")
    if node is None or not (repository / COMPILER).is_file():
        pytest.skip("no TypeScript; `make lint` installs it")
    for name, payload in payloads.items():
        content = f"export const payload: Payload = {json.dumps(payload)};\n"
        (folder / f"{name}.ts").write_text(content)
    settings = {
        "compilerOptions": {"noEmit": True, "strict": True, "types": []},
        "files": [str(repository / TYPES), *(f"{name}.ts" for name in payloads)],
    }
    (folder / "tsconfig.json").write_text(json.dumps(settings))
    command: list[str] = [node, str(repository / COMPILER), "-p", str(folder)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=folder)
    return done.stdout + done.stderr


@pytest.mark.slow
def test_payloads_have_the_shape(faults: dict[str, list[str]]) -> None:
    """Those of a report, and those that the tests of the page make up."""
    assert [faults[name] for name in ("report", "small", "lone")] == [[], [], []]


@pytest.mark.slow
def test_another_shape_is_noticed(faults: dict[str, list[str]]) -> None:
    [fault] = faults["wrong"]
    assert "'string' is not assignable to type 'number'" in fault
