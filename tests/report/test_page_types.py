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


def _faults(repository: Path, payload: dict[str, Any], folder: Path) -> str:
    """What the compiler says of a payload as a literal of the type."""
    beside = str(Path(sys.executable).parent)
    node = shutil.which("node", path=beside) or shutil.which("node")
    if node is None or not (repository / COMPILER).is_file():
        pytest.skip("no TypeScript; `make lint` installs it")
    (folder / "payload.ts").write_text(f"export const payload: Payload = {json.dumps(payload)};\n")
    settings = {
        "compilerOptions": {"noEmit": True, "strict": True, "types": []},
        "files": [str(repository / TYPES), "payload.ts"],
    }
    (folder / "tsconfig.json").write_text(json.dumps(settings))
    command: list[str] = [node, str(repository / COMPILER), "-p", str(folder)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return done.stdout + done.stderr


@pytest.mark.slow
def test_a_report_has_the_shape(flight: Results, repository: Path, tmp_path: Path) -> None:
    page = write_report(flight, tmp_path / "report.html", resamples=50)
    assert _faults(repository, payload_in(page), tmp_path) == ""


@pytest.mark.slow
def test_made_up_payloads_have_the_shape(repository: Path, tmp_path: Path) -> None:
    for payload in (small_payload(), lone_payload()):
        assert _faults(repository, json.loads(json.dumps(payload)), tmp_path) == ""


@pytest.mark.slow
def test_another_shape_is_noticed(repository: Path, tmp_path: Path) -> None:
    payload = lone_payload()
    payload["entries"][0]["score"]["best"] = "the first"
    assert "'string' is not assignable to type 'number'" in _faults(repository, payload, tmp_path)
