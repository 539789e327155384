"""Pages of real results in a browser: what Python writes is what the page reads."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import aerocues
from aerocues import Results
from tests.report.made_up import COMBINATIONS, folder_of, measured

Open = Callable[..., Any]


def draw_all(opened: Any) -> list[str]:
    """Scroll to every figure and wait until it is drawn; their names."""
    found = opened.page.evaluate(
        "[...document.querySelectorAll('[id^=figure-]')]"
        ".filter(each => each.offsetParent).map(each => each.id.slice(7))"
    )
    for name in found:
        opened.figure(name)
    return [str(name) for name in found]


def test_a_run_with_pictures(open_report: Open, finished: Results, tmp_path: Path) -> None:
    page = aerocues.write_report(finished, tmp_path / "page.html", resamples=50)
    opened = open_report(file=page)
    assert len(draw_all(opened)) > 10
    assert sorted(opened.rows()) == sorted(finished.settings["combinations"])
    assert opened.page.locator("#pictures").is_visible()
    assert opened.page.locator("#pictures canvas, #pictures svg, #pictures img").count()


def test_two_machines(open_report: Open, two_machines: list[Results], tmp_path: Path) -> None:
    page = aerocues.write_report(two_machines, tmp_path / "page.html", resamples=50)
    opened = open_report(file=page, plotly=False)
    assert draw_all(opened)
    assert "flight (board)" in opened.page.inner_text("body")


def test_one_combination_on_one_pair(open_report: Open, tmp_path: Path) -> None:
    results = folder_of(measured(combinations=COMBINATIONS[:1], pairs=1), tmp_path)
    page = aerocues.write_report(results, tmp_path / "page.html", resamples=50)
    opened = open_report(file=page, plotly=False)
    draw_all(opened)
    assert opened.rows() == list(COMBINATIONS[:1])
