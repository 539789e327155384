"""Vector figures for a paper."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import pytest

from aerocues import Results
from aerocues.errors import MethodUnavailableError, StoreError
from aerocues.report import figures
from aerocues.report.figures import FIGURES, write_figures
from aerocues.report.matrix_figures import draw_platforms, draw_stability
from aerocues.report.report import report_entries
from tests.report.made_up import COMBINATIONS, folder_of, measured
from tests.report.made_up_models import with_models

pytest.importorskip("matplotlib")


@pytest.fixture
def scores_only(monkeypatch: pytest.MonkeyPatch) -> None:
    """One figure of all; the others take long."""
    monkeypatch.setattr(figures, "FIGURES", {"cues": FIGURES["cues"]})
    monkeypatch.setattr(figures, "ACROSS", {})


@pytest.mark.slow
def test_every_figure_is_drawn_twice(tmp_path: Path) -> None:
    results = with_models(tmp_path)
    files = write_figures(report_entries([results], resamples=50), tmp_path / "new" / "figures")
    names = {f"{name}.{form}" for name in FIGURES for form in ("svg", "pdf")}
    assert {file.name for file in files} == names
    for file in files:
        if file.suffix == ".svg":
            root = ET.fromstring(file.read_text(encoding="utf-8"))
            assert root.tag.endswith("svg")
        else:
            assert file.read_bytes().startswith(b"%PDF")


@pytest.mark.slow
@pytest.mark.usefixtures("scores_only")
def test_the_same_data_give_the_same_files(flight: Results, tmp_path: Path) -> None:
    contents = []
    for name in ("one", "two"):
        entries = report_entries([flight], resamples=50)
        files = write_figures(entries, tmp_path / name)
        contents.append([file.read_bytes() for file in files])
    assert contents[0] == contents[1]


@pytest.mark.slow
@pytest.mark.usefixtures("scores_only")
def test_several_entries_do_not_overwrite_each_other(
    two_machines: list[Results], tmp_path: Path
) -> None:
    files = write_figures(report_entries(two_machines, resamples=50), tmp_path)
    assert len(set(files)) == 4
    assert (tmp_path / "flight-board-cues.svg").is_file()


def test_entries_are_drawn_together(two_machines: list[Results]) -> None:
    both = report_entries(two_machines, resamples=2)
    stability, platforms = draw_stability(both), draw_platforms(both)
    assert stability is not None
    assert stability.axes[0].get_title() == "Spearman's correlation of the rankings"
    assert platforms is not None
    assert "of the first 10 stay" in platforms.axes[0].get_title()
    assert (draw_stability(both[:1]), draw_platforms(both[:1])) == (None, None)


@pytest.mark.usefixtures("scores_only")
def test_names_in_the_data_are_no_formulas(tmp_path: Path) -> None:
    results = folder_of(measured(dataset="$a_b$ <b>"), tmp_path / "results")
    write_figures(report_entries([results], resamples=50), tmp_path)
    assert ET.parse(tmp_path / "cues.svg")


def test_what_was_not_measured_is_not_drawn(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    kept = ("times", "critical-difference", "models", "models-relation", "cues")
    monkeypatch.setattr(figures, "FIGURES", {name: FIGURES[name] for name in kept})
    stages = ("detect_seconds_1", "describe_seconds_1", "match_seconds", "verify_seconds")
    untimed: dict[str, Any] = dict.fromkeys(stages)
    rows = measured(combinations=COMBINATIONS[:1], pairs=1, **untimed)
    results = folder_of(rows, tmp_path / "results")
    files = write_figures(report_entries([results], resamples=50), tmp_path)
    assert {file.stem for file in files} == {"cues"}


def test_without_matplotlib(
    flight: Results, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(MethodUnavailableError, match=r"aerocues\[figures\]"):
        write_figures(report_entries([flight], resamples=50), tmp_path)


def test_a_folder_that_cannot_be_made(flight: Results, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(StoreError, match="figures"):
        write_figures(report_entries([flight], resamples=50), tmp_path / "file" / "figures")
