"""The first screen: which combination to take, for what, how sure, and the flight."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.report.conftest import Opened, written
from tests.report.small_models import small_models
from tests.report.small_payload import METHODS, RACE, entry_of, frame_of

Open = Callable[..., Opened]


def _taken(opened: Opened) -> str:
    return str(opened.page.inner_text("#verdict .lead strong"))


def test_a_purpose_and_weights_rank_anew(open_report: Open) -> None:
    opened = open_report(plotly=False)
    assert _taken(opened) == "SIFT-SIFT-L2-BF"
    opened.page.click('[data-purpose="memory"]')
    assert opened.fragment() == "decide.purpose=memory"
    opened.page.click('[data-purpose="own"]')
    before = opened.page.locator(".candidates button").all_inner_texts()
    opened.page.click(".answer > .disclosure > summary")
    opened.page.fill('[data-aspect="memory"]', "10")
    opened.page.fill('[data-aspect="accuracy"]', "0")
    assert "decide.memory=10" in opened.fragment()
    assert opened.page.locator(".candidates button").all_inner_texts() != before
    opened.page.click('[data-purpose="overall"]')
    assert _taken(opened) == "SIFT-SIFT-L2-BF"


def test_the_answer_can_be_copied(open_report: Open) -> None:
    opened = open_report(permissions=["clipboard-read", "clipboard-write"], plotly=False)
    opened.page.click("text=Copy command")
    opened.page.wait_for_selector("text=Copied")
    command = "aerocues use SIFT-SIFT-L2-BF --as python -o sift_sift_l2_bf.py"
    assert opened.page.evaluate("navigator.clipboard.readText()") == command


@pytest.mark.parametrize("width", [1440, 390])
def test_the_answer_is_on_the_first_screen(open_report: Open, width: int) -> None:
    opened = open_report(viewport={"width": width, "height": 900 if width > 900 else 844})
    last = ".copies" if width > 900 else ".sure"
    box = opened.page.locator(last).bounding_box()
    assert box is not None
    assert box["y"] + box["height"] <= 844
    assert opened.page.locator("#figure-pareto").evaluate(
        "each => each.getBoundingClientRect().top < 300"
    ) == (width > 900)


def test_a_pair_on_the_map_opens(open_report: Open) -> None:
    opened = open_report()
    opened.figure("map")
    images = opened.page.evaluate("JSON.parse(payload.textContent).maps[0].images.length")
    assert opened.page.locator("#figure-map .footprints polygon").count() == images
    edge = opened.page.locator("#figure-map .edge").first
    edge.focus()
    opened.page.keyboard.press("Enter")
    assert "SIFT-SIFT-L2-BF" in opened.page.inner_text("#drawer")
    opened.page.keyboard.press("Escape")
    assert opened.page.locator("#drawer").is_hidden()
    assert edge.evaluate("each => each === document.activeElement")


def test_a_race_gives_its_own_answer_and_how_much_it_measured(
    open_report: Open, tmp_path: Path
) -> None:
    final = {"images": 12, "of": 120, "models": ["KAZE-KAZE-L2-BF"], "unfinished": []}
    models = small_models(METHODS, "")
    models["values"]["pairs"] = [30] * len(METHODS)
    entry = {
        **entry_of("images", seed=0, name="images"),
        "race": {**RACE, "final": final},
        "models": models,
    }
    opened = open_report(file=written(frame_of([entry]), tmp_path / "race.html"))
    assert _taken(opened) == "KAZE-KAZE-L2-BF"
    assert "Most accurate: SIFT-SIFT-L2-BF" in opened.page.inner_text("#verdict")
    words = opened.page.locator(".sure").first.inner_text()
    assert "12 of 466 combinations on up to 8 of 153 pairs" in words
    assert "ORB-ORB-HAM-BF led with a probability of 40" in words
    # The models are of a block of a tenth of the images.
    assert "Your 120 images, about 300 pairs" in opened.page.inner_text("#verdict")
    opened.page.click('[data-purpose="overall"]')
    assert _taken(opened) == "SIFT-SIFT-L2-BF"
