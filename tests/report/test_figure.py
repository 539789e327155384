"""Figures of the page as Plotly figures."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import aerocues
from aerocues import AerocuesError, Results
from aerocues.datasets.synthetic import EXTENDED
from aerocues.errors import ArgumentError, ScoreError
from aerocues.report.figure import SECTIONS
from aerocues.report.interactive.view import View
from aerocues.report.report import report_entries
from tests.report.made_up import COMBINATIONS, folder_of, measured
from tests.report.made_up_models import with_models

# The others need images, several results, or a graded series: they have tests of their own.
OF_ONE = sorted(SECTIONS.keys() - {"matches", "machines", "rankings", "ranks", "curves"})
FEW: dict[str, Any] = {"resamples": 20}


def view_of(results: list[Results], **changes: Any) -> View:
    entries = report_entries(results, resamples=20)
    order = entries[0].ranking.scores.order
    return View(entries, entries[0], order, **{"top": 3, **changes})


@pytest.fixture(scope="module")
def modelled(tmp_path_factory: pytest.TempPathFactory) -> View:
    """Made-up results with ground truth, times of stages, and models."""
    return view_of([with_models(tmp_path_factory.mktemp("modelled"))])


@pytest.mark.parametrize("section", OF_ONE)
def test_every_figure_of_one_dataset_has_its_data(modelled: View, section: str) -> None:
    drawn = SECTIONS[section](modelled)
    if isinstance(drawn, str):
        assert section in ("ground-truth", "ground-truth-correlations", "matchers"), drawn
        return
    assert len(drawn.data) > 0
    assert drawn.to_json()
    names = {text for trace in drawn.data for text in np.ravel(trace.y).tolist()}
    if section in ("cues", "times", "distributions", "times-per-thousand"):
        assert names == set(modelled.named(modelled.best))


def test_figures_of_several_results(two_machines: list[Results]) -> None:
    view = view_of(two_machines)
    for section in ("machines", "rankings", "ranks"):
        drawn = SECTIONS[section](view)
        assert not isinstance(drawn, str)
        assert len(drawn.data) > 0


def test_curves_follow_graded_transformations(tmp_path: Path) -> None:
    names = [row.name for row in EXTENDED if row.kind == "rotation"][:4]
    rows = [
        {**row, "image_1": "original", "image_2": names[row["pair"]], "sequence": "rotation"}
        for row in measured(dataset="synthetic", pairs=len(names))
    ]
    drawn = SECTIONS["curves"](view_of([folder_of(rows, tmp_path)], column="inliers"))
    assert not isinstance(drawn, str)
    assert len(drawn.data) == 3
    assert sorted(drawn.data[0].x) == sorted(
        float(row.value) for row in EXTENDED if row.name in names
    )


def test_one_call_draws_a_section_of_chosen_combinations(flight: Results) -> None:
    drawn = aerocues.figure(flight.folder, "cues", combinations="ORB-*", **FEW)
    assert set(drawn.data[0].y) == {name for name in COMBINATIONS if name.startswith("ORB-")}
    assert set(aerocues.figure(flight, top=2, **FEW).data[0].y) <= set(COMBINATIONS)
    assert len(aerocues.figure(flight, top=2, **FEW).data[0].y) == 2


def test_matches_are_found_again(finished: Results) -> None:
    drawn = aerocues.figure(finished, "matches", combinations="ORB-ORB-HAM-BF", pair=1, **FEW)
    row = finished.sql("SELECT inliers FROM results WHERE pair = 1 AND detector = 'ORB'")
    assert drawn.data[0].name == f"{row['inliers'].item()} inliers"
    assert len(drawn.layout.images) == 2


def test_what_match_found_is_drawn(photos: Path) -> None:
    found = aerocues.match(photos / "0.png", photos / "1.png", "ORB-ORB-HAM-BF")
    drawn = aerocues.figure(found)
    assert drawn.data[0].name == f"{int(found.inliers.sum())} inliers"
    assert drawn.data[1].visible == "legendonly"
    x = np.asarray(drawn.data[0].x)[:2]
    first = np.flatnonzero(found.inliers)[0]
    assert x[0] == found.points_1[first, 0]
    assert x[1] == found.points_2[first, 0] + found.images[0].shape[1]


@pytest.mark.parametrize(
    ("options", "error"),
    [
        ({"section": "scores"}, ArgumentError),
        ({"section": "cues", "top": 0}, ArgumentError),
        ({"section": "cues", "combinations": "KAZE-*"}, ArgumentError),
        ({"section": "cues", "dataset": "other"}, ArgumentError),
        ({"section": "distributions", "column": "beauty"}, ArgumentError),
        ({"section": "rankings"}, ScoreError),
        ({"section": "cloud"}, ScoreError),
        ({"section": "matches"}, ScoreError),
        ({"section": "cues", "criteria": "beauty"}, AerocuesError),
    ],
)
def test_what_cannot_be_drawn_is_told(
    flight: Results, options: dict[str, Any], error: type[AerocuesError]
) -> None:
    with pytest.raises(error):
        aerocues.figure(flight, **{**FEW, **options})
