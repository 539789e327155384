"""What the page must not claim, and what it must point out."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.report.conftest import Opened, written
from tests.report.small_payload import entry_of, frame_of

Open = Callable[..., Opened]
UNTESTED = 4


@pytest.fixture(scope="module")
def doubtful(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One combination was not compared with the best, and counts have most of the weight."""
    entry = entry_of("images", seed=0, name="images")
    score: dict[str, Any] = entry["score"]
    score["p_value"][UNTESTED] = None
    score["untested"] = [UNTESTED]
    score["weights"]["values"]["aggregate"] = [0.2, 0.7, 0.1]
    entry["columns"]["seconds_per_1k_inliers"] |= entry["columns"]["precision"]
    return written(frame_of([entry]), tmp_path_factory.mktemp("doubtful") / "report.html")


def test_what_was_not_compared_is_not_drawn_as_worse(open_report: Open, doubtful: Path) -> None:
    opened = open_report(file=doubtful)
    opened.figure("dots")
    legend = opened.page.locator("#figure-dots .legendtext").all_text_contents()
    assert "Hamming, not compared" in legend
    assert "Hamming, significantly worse" in legend


def test_a_large_weight_of_counts_is_pointed_out(open_report: Open, doubtful: Path) -> None:
    opened = open_report(file=doubtful)
    opened.figure("weights")
    note = opened.page.locator("#figure-weights > .note").inner_text()
    assert note.startswith("Counts have 70\u00a0% of the weight (inliers)")


def test_scores_are_compared_with_the_truth(open_report: Open, doubtful: Path) -> None:
    opened = open_report(file=doubtful)
    opened.figure("truthmatrix")
    rows = opened.page.locator("#figure-truthmatrix .ytick").all_text_contents()
    assert {"CUES", "preset “thesis”"} < set(rows)


def test_an_axis_of_near_values_has_ticks(open_report: Open, doubtful: Path) -> None:
    opened = open_report("#thousand.scale=log", file=doubtful)
    opened.figure("thousand")
    assert opened.page.locator("#figure-thousand .xtick").count() >= 3


def test_the_contents_follow_on_a_phone(open_report: Open) -> None:
    opened = open_report(viewport={"width": 390, "height": 800}, plotly=False)
    opened.page.evaluate("document.querySelector('#method').scrollIntoView()")
    opened.page.wait_for_function("() => document.querySelector('#contents').scrollLeft > 0")
    link = opened.page.locator('#contents a[href="#method"]')
    box = link.bounding_box()
    assert box is not None
    assert box["x"] + box["width"] <= 390
