"""What is recorded of the software and of the machine, also where little of it is installed."""

from __future__ import annotations

import re
from importlib.metadata import PackageNotFoundError
from pathlib import Path

import cv2
import pytest

from aerocues.results import versions


def test_the_version_of_opencv_is_known_where_it_is_no_package(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def nothing_installed(name: str) -> str:
        raise PackageNotFoundError(name)

    monkeypatch.setattr(versions, "version", nothing_installed)
    found = versions.software_versions()
    assert found["opencv"] == cv2.__version__
    assert set(found) == {"python", "opencv"}


def test_versions_are_those_of_what_is_installed() -> None:
    found = versions.software_versions()
    assert {"aerocues", "numpy", "polars"} < found.keys()
    assert all(re.match(r"\d+\.\d+", number) for number in found.values())


def test_a_board_is_called_what_it_says_it_is(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    model = tmp_path / "model"
    model.write_bytes(b"Raspberry Pi 5 Model B Rev 1.0\0")
    monkeypatch.setattr(versions, "BOARD", model)
    assert re.fullmatch(r"Raspberry Pi 5 Model B Rev 1\.0, \d+ cores", versions.machine_name())


def test_a_machine_that_is_no_board_is_called_after_its_processor(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(versions, "BOARD", tmp_path / "missing")
    name = versions.machine_name()
    assert re.fullmatch(r".+, \d+ cores", name)
    (tmp_path / "missing").write_bytes(b"\0")
    assert versions.machine_name() == name


def test_the_governor_of_the_clock_is_recorded_where_there_is_one(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(versions, "CORES", tmp_path)
    assert "governor" not in versions.machine_facts()
    for core in range(2):
        folder = tmp_path / f"cpu{core}" / "cpufreq"
        folder.mkdir(parents=True)
        (folder / "scaling_governor").write_text("performance\n")
    assert versions.machine_facts()["governor"] == "performance"
