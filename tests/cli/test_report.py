"""`aerocues report`."""

from __future__ import annotations

from pathlib import Path

import pytest
import typer

from tests.cli.conftest import Call
from tests.report.decoding import payload_in
from tests.report.made_up import folder_of, measured


@pytest.mark.slow
def test_a_page_is_written(
    call: Call, finished: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    answer = call("report", finished, "--resamples", 50, "--pictures", 1)
    assert answer.code == 0, answer.err
    assert answer.out.startswith("report.html (")
    payload = payload_in(tmp_path / "report.html")
    assert payload["pictures"]
    assert len(payload["entries"][0]["combinations"]) == 4


def test_options_reach_the_page(call: Call, finished: Path, tmp_path: Path) -> None:
    page = tmp_path / "mine.html"
    words = ["--title", "Mine", "--criteria", "precision,matches", "--alpha", "0.25"]
    answer = call("report", finished, "-o", page, *words, "--pictures", 0, "--resamples", 50)
    assert answer.code == 0, answer.err
    payload = payload_in(page)
    assert payload["title"] == "Mine"
    assert payload["pictures"] == []
    settings = payload["entries"][0]["score"]["settings"]
    assert settings["criteria"] == ["precision", "matches"]
    assert settings["alpha"] == 0.25


def test_several_results_in_one_page(call: Call, finished: Path, tmp_path: Path) -> None:
    other = folder_of(measured(), tmp_path).folder
    page = tmp_path / "page.html"
    answer = call("report", finished, other, "-o", page, "--pictures", 0, "--resamples", 50)
    assert answer.code == 0, answer.err
    assert [entry["name"] for entry in payload_in(page)["entries"]] == ["photos", "flight"]


def test_the_page_is_opened_where_asked(
    call: Call, finished: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened: list[str] = []
    monkeypatch.setattr(typer, "launch", opened.append)
    page = tmp_path / "page.html"
    answer = call("report", finished, "-o", page, "--open", "--pictures", 0, "--resamples", 50)
    assert answer.code == 0, answer.err
    assert opened == [str(page)]


def test_markdown_goes_to_standard_output_or_a_file(
    call: Call, finished: Path, tmp_path: Path
) -> None:
    words = ["report", finished, "--format", "markdown", "--resamples", 50]
    printed = call(*words)
    assert printed.code == 0, printed.err
    assert printed.out.startswith("# Local features on photos\n\n**`")
    written = call(*words, "-o", tmp_path / "summary.md")
    assert written.code == 0, written.err
    assert (tmp_path / "summary.md").read_text(encoding="utf-8") == printed.out


@pytest.mark.slow
def test_figures_are_written_alone_or_beside_the_page(
    call: Call, finished: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("matplotlib")
    monkeypatch.chdir(tmp_path)
    answer = call("report", finished, "--figures", "figures", "--resamples", 50)
    assert answer.code == 0, answer.err
    assert "figures" in answer.err
    assert (tmp_path / "figures" / "cues.pdf").is_file()
    assert not (tmp_path / "report.html").exists()


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["missing"], "error: "),
        (["RESULTS", "--dataset", "x"], "error: "),
        (["RESULTS", "--criteria", "beauty"], "'beauty'"),
        (["RESULTS", "--images", "oxfrd:x"], "oxford"),
        (["RESULTS", "--max-megabytes", "1"], "error: "),
        (["RESULTS", "-o", "missing/page.html", "--pictures", "0"], "missing"),
        ([], "error: "),
    ],
)
def test_mistakes_are_told_in_one_line(
    call: Call,
    finished: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    words: list[str],
    told: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    words = [str(finished) if word == "RESULTS" else word for word in words]
    answer = call("report", *words, "--resamples", 50)
    assert answer.code == 2
    assert answer.err.startswith("error: ")
    assert told in answer.err
    assert answer.err.count("\n") == 1
