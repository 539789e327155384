"""The short text."""

from __future__ import annotations

import re
from pathlib import Path

import polars as pl

from aerocues import Results
from aerocues.report.markdown import summary
from aerocues.report.payload import payload_of
from aerocues.report.report import report_entries
from aerocues.results.store import Store
from tests.report.made_up import COMBINATIONS, folder_of, measured
from tests.report.made_up_models import made_models, with_models


def test_the_answer_comes_first(flight: Results) -> None:
    text = summary(report_entries([flight], resamples=50), "Mine")
    lines = text.splitlines()
    assert lines[0] == "# Mine"
    assert re.match(r"\*\*`ORB-ORB-HAM-BF`\*\* .* 5 combinations on 6 image", lines[2])
    assert text.count("\n| ") == len(COMBINATIONS) + 2
    assert "resamples" in lines[-1]


def test_several_entries_have_headings_and_a_comparison(two_machines: list[Results]) -> None:
    text = summary(report_entries(two_machines, resamples=50), "Mine")
    headings = [line for line in text.splitlines() if line.startswith("## ")]
    assert headings == ["## flight (desk)", "## flight (board)", "## Across all datasets"]


def test_names_in_the_data_are_text(tmp_path: Path) -> None:
    nasty = "<img src=x> [a](b) | `c`"
    results = folder_of(measured(dataset=nasty), tmp_path)
    text = summary(report_entries([results], resamples=50), nasty)
    assert "<img" not in text.replace("\\<img", "")
    assert r"\[a\](b) \| \`c\`" in text


def test_one_pair_promises_nothing(tmp_path: Path) -> None:
    results = folder_of(measured(pairs=1), tmp_path)
    text = summary(report_entries([results], resamples=50), "Mine")
    assert "interval" not in text


def test_few_sequences_are_cautioned_about(tmp_path: Path) -> None:
    rows = measured()
    for row in rows:
        row["sequence"] = "ab"[row["pair"] % 2]
    entries = report_entries([folder_of(rows, tmp_path)], resamples=50)
    note = payload_of(entries, "Mine")["method"]["notes"][0]
    assert "2 sequences" in note
    assert "2 sequences" in summary(entries, "Mine")


def test_figures_of_models_may_be_missing(tmp_path: Path) -> None:
    results = with_models(tmp_path)
    methods = ("dataset", "detector", "descriptor", "norm", "matcher")
    points = pl.when(pl.col("detector") != "AKAZE").then(pl.col("points_3d"))
    figures = ("reprojection_error", "reconstruction_seconds")
    few = made_models()[0].select(*methods, "status", points, *figures)
    Store.open(results.folder).write_reconstructions(few)
    text = summary(report_entries([results], resamples=50), "Mine")
    assert "- `ORB-ORB-HAM-BF`: 12,000 points, 0.60 px\n" in text
    assert "- `AKAZE-AKAZE-HAM-BF`: 0.70 px\n" in text
