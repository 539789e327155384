"""Whether everyone can use the page: by keyboard, by ear, in the dark, on paper."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.report.conftest import Opened
from tests.report.test_page_sections import FIGURES

Open = Callable[..., Opened]


def _violations(opened: Opened) -> list[str]:
    package = pytest.importorskip("axe_playwright_python", reason="axe is not installed")
    script = Path(package.__file__).with_name("axe.min.js").read_text(encoding="utf-8")
    opened.page.evaluate(script)
    found: dict[str, Any] = opened.page.evaluate("axe.run({resultTypes: ['violations']})")
    return [
        f"{violation['id']}: {node['html'][:200]} {node['failureSummary']}"
        for violation in found["violations"]
        if violation["impact"] in ("serious", "critical")
        for node in violation["nodes"]
    ]


@pytest.mark.parametrize(("scheme", "width"), [("light", 1280), ("dark", 390)])
def test_axe_finds_nothing_serious_and_nothing_is_wider_than_the_window(
    open_report: Open, scheme: str, width: int
) -> None:
    opened = open_report("#q=sift", viewport={"width": width, "height": 900}, color_scheme=scheme)
    opened.page.click("#methods-summary")
    for summary in opened.page.locator("#sections summary").all():
        summary.click()
    for name in FIGURES:
        opened.figure(name)
    assert opened.page.evaluate("document.documentElement.scrollWidth") <= width
    assert _violations(opened) == []


def test_the_page_is_used_by_keyboard(open_report: Open) -> None:
    opened = open_report(plotly=False)
    opened.page.keyboard.press("Tab")
    assert opened.page.evaluate("document.activeElement.className") == "skip"
    opened.page.focus("#filter")
    opened.page.keyboard.type("orb")
    heading = '#ranking th[data-key="combination"] button'
    opened.page.focus(heading)
    opened.page.keyboard.press("Enter")
    assert opened.page.evaluate("document.activeElement.textContent") == "Combination"
    assert opened.rows()[0] == "<b>MINE-ORB-HAM-BF"
    assert "Combination" in str(opened.page.text_content("#announcer"))
    opened.page.focus("#methods-summary")
    opened.page.keyboard.press("Enter")
    assert opened.page.locator("#methods .panel").is_visible()
    opened.page.keyboard.press("Escape")
    assert opened.page.locator("#methods .panel").is_hidden()
    opened.page.focus('#contents a[href="#method"]')
    opened.page.keyboard.press("Enter")
    assert opened.page.evaluate("document.activeElement.id") == "title-method"


def _wait_for_theme(opened: Opened, theme: str) -> None:
    opened.page.wait_for_function(
        "theme => document.documentElement.dataset.theme === theme", arg=theme
    )


def test_light_and_dark_follow_the_system_until_chosen(open_report: Open) -> None:
    opened = open_report(color_scheme="dark", plotly=False)
    _wait_for_theme(opened, "dark")
    opened.page.emulate_media(color_scheme="light")
    _wait_for_theme(opened, "light")
    opened.page.click("#theme")
    _wait_for_theme(opened, "dark")
    assert opened.fragment() == "theme=dark"
    opened.page.emulate_media(color_scheme="dark")
    opened.page.click("#theme")
    _wait_for_theme(opened, "light")


HELD = """
  const Real = window.DecompressionStream;
  const held = new Promise(done => { window.release = done; });
  window.DecompressionStream = class {
    constructor(kind) {
      const hold = async (chunk, stream) => { await held; stream.enqueue(chunk); };
      const [real, gate] = [new Real(kind), new TransformStream({transform: hold})];
      real.readable.pipeTo(gate.writable);
      Object.assign(this, {writable: real.writable, readable: gate.readable});
    }
  };
"""
"""Holds back what is unpacked until the page is told to release it."""


def test_paper_before_plotly_says_what_is_not_drawn(open_report: Open) -> None:
    opened = open_report()
    opened.page.add_init_script(HELD)
    opened.page.reload()
    opened.page.evaluate("window.dispatchEvent(new Event('beforeprint'))")
    drawn = "figure.figure:has(.main-svg)"
    assert opened.page.locator(drawn).count() > 0
    told = opened.page.locator("figure.figure .nothing", has_text="not drawn yet")
    assert told.count() > 0
    assert opened.page.locator("figure.figure:not(:has(.main-svg, .nothing))").count() == 0
    opened.page.evaluate("window.dispatchEvent(new Event('afterprint')); release()")
    opened.page.locator("#figure-weights").scroll_into_view_if_needed()
    opened.page.wait_for_selector("#figure-weights .main-svg")


def test_paper_has_every_figure(open_report: Open) -> None:
    opened = open_report(color_scheme="dark")
    opened.figure("heat")
    opened.page.evaluate("window.dispatchEvent(new Event('beforeprint'))")
    assert opened.page.locator("figure.figure:not(:has(.main-svg))").count() == 0
    assert opened.page.evaluate("document.documentElement.dataset.theme") == "light"
    widest = "Math.max(...[...document.querySelectorAll('.main-svg')].map(e => e.clientWidth))"
    assert opened.page.evaluate(widest) <= 680
    opened.page.evaluate("window.dispatchEvent(new Event('afterprint'))")
    _wait_for_theme(opened, "dark")
    opened.page.emulate_media(media="print")
    assert opened.page.locator("#toolbar").is_hidden()
