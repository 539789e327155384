from __future__ import annotations

import re
from pathlib import Path

import pytest

from aerocues.cli.program import BAD_INPUT, exit_code
from aerocues.datasets.catalog import open_dataset


@pytest.mark.slow
def test_a_mini_flight_and_its_continuation(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ["simulate", "-o", str(tmp_path), "--scene", "fields", "--size", "64x48"]
    assert exit_code(arguments) == 0
    assert re.search(r"\b6 images", capsys.readouterr().out)
    assert len(open_dataset(f"simulated:{tmp_path}").pairs) == 5
    assert exit_code(arguments) == 0
    assert "6 kept" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("option", "value"),
    [("--size", "big"), ("--sun", "noon"), ("--survey", "none"), ("--format", "gif")],
)
def test_what_makes_no_sense_is_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], option: str, value: str
) -> None:
    assert exit_code(["simulate", "-o", str(tmp_path), option, value]) == BAD_INPUT
    assert value in capsys.readouterr().err
