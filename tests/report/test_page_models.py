"""The section of 3D models: its table, its clouds, its figures."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.report.conftest import Opened
from tests.report.small_models import CLOUDS, REFERENCE
from tests.report.small_payload import HARMFUL, names_of

Open = Callable[..., Opened]
TABLE = "#reconstructions"


def rows(opened: Opened) -> list[str]:
    return opened.page.locator(f"{TABLE} tbody th").all_inner_texts()


def pixels(opened: Opened, side: str = "left") -> str:
    drawn = opened.page.evaluate(f"document.querySelector('canvas[data-side={side}]').toDataURL()")
    return str(drawn)


def test_models_are_in_the_order_of_the_data(open_report: Open) -> None:
    """Which is that of `best_first`."""
    opened = open_report(plotly=False)
    assert rows(opened) == names_of()
    assert names_of()[0] == REFERENCE
    assert HARMFUL in opened.page.inner_text(TABLE)
    assert opened.page.evaluate("window.harmed") is None


def test_the_table_is_sorted_filtered_and_saved(open_report: Open, tmp_path: Path) -> None:
    opened = open_report(plotly=False)
    opened.page.click(f'{TABLE} th[data-key="points_3d"] button')
    assert "models.sort=-points_3d" in opened.fragment()
    opened.page.click(f'{TABLE} th[data-key="points_3d"] button')
    # The fewest points first; what has none comes last.
    assert rows(opened)[0] == names_of()[10]
    assert set(rows(opened)[-2:]) == {names_of()[5], names_of()[11]}
    opened.page.fill("#filter", "and sift -flann")
    assert all("SIFT" in name and "FLANN" not in name for name in rows(opened))
    with opened.page.expect_download() as download:
        opened.page.click("#save-reconstructions")
    download.value.save_as(tmp_path / "models.csv")
    saved = list(csv.DictReader(io.StringIO((tmp_path / "models.csv").read_text())))
    assert [row["combination"] for row in saved] == rows(opened)
    assert {"status", "points_3d", "message", "cloud_distance_rms"} <= set(saved[0])


def test_clouds_are_turned_together(open_report: Open) -> None:
    opened = open_report(plotly=False)
    opened.page.locator("#clouds").scroll_into_view_if_needed()
    before = [pixels(opened, side) for side in ("left", "right")]
    opened.page.focus("canvas[data-side=left]")
    opened.page.keyboard.press("ArrowRight")
    after = [pixels(opened, side) for side in ("left", "right")]
    assert all(old != new for old, new in zip(before, after, strict=True))
    opened.page.keyboard.press("Home")
    assert [pixels(opened, side) for side in ("left", "right")] == before
    for label in ("Zoom in", "View more from above", "Turn to the left"):
        opened.page.get_by_role("button", name=label).click()
    assert pixels(opened) != before[0]
    box = opened.page.locator("canvas[data-side=left]").bounding_box()
    assert box is not None
    turned = pixels(opened)
    opened.page.mouse.move(box["x"] + 100, box["y"] + 100)
    opened.page.mouse.down()
    opened.page.mouse.move(box["x"] + 160, box["y"] + 120, steps=3)
    opened.page.mouse.up()
    assert pixels(opened) != turned


def test_clouds_turn_by_themselves_only_when_asked(open_report: Open) -> None:
    opened = open_report(plotly=False)
    opened.page.locator("#clouds").scroll_into_view_if_needed()
    still = pixels(opened)
    opened.page.evaluate("new Promise(done => { requestAnimationFrame(() => setTimeout(done)); })")
    assert pixels(opened) == still
    opened.page.click("#turn-clouds")
    assert opened.page.get_attribute("#turn-clouds", "aria-pressed") == "true"
    opened.page.wait_for_function(
        "still => document.querySelector('canvas[data-side=left]').toDataURL() !== still", arg=still
    )
    opened.page.click("#turn-clouds")
    assert opened.page.inner_text("#turn-clouds") == "Turn"


@pytest.mark.parametrize("colour", ["height", "distance", "error", "track"])
def test_points_are_coloured_by_what_is_asked(open_report: Open, colour: str) -> None:
    opened = open_report(plotly=False)
    opened.page.locator("#clouds").scroll_into_view_if_needed()
    before = pixels(opened)
    assert opened.page.locator(".cloud-legend").is_hidden()
    opened.page.locator("#clouds select").nth(2).select_option(colour)
    assert f"cloud.colour={colour}" in opened.fragment()
    assert pixels(opened) != before
    assert opened.page.locator(".cloud-legend .scale").is_visible()


def test_layers_and_choice_stand_in_the_address(open_report: Open) -> None:
    opened = open_report(f"#cloud.left={CLOUDS[2]}&cloud.cameras=no", plotly=False)
    opened.page.locator("#clouds").scroll_into_view_if_needed()
    titles = opened.page.locator(".panel-of-cloud h4").all_inner_texts()
    assert titles == [CLOUDS[2], CLOUDS[1]]
    before = pixels(opened)
    opened.page.locator('#clouds input[data-layer="cameras"]').check()
    assert pixels(opened) != before
    with_truth = pixels(opened)
    opened.page.locator('#clouds input[data-layer="truth"]').uncheck()
    assert pixels(opened) != with_truth
    assert "cloud.truth=no" in opened.fragment()
    words = opened.page.locator(".panel-of-cloud").first.inner_text()
    assert re.search(r"200 of 250 points .*\b1 point\b", words)


def test_a_cloud_is_saved_as_a_picture(open_report: Open, tmp_path: Path) -> None:
    opened = open_report(plotly=False)
    opened.page.locator("#clouds").scroll_into_view_if_needed()
    with opened.page.expect_download() as download:
        opened.page.get_by_label("Save the left cloud as PNG").click()
    download.value.save_as(tmp_path / "cloud.png")
    assert (tmp_path / "cloud.png").read_bytes().startswith(b"\x89PNG")


def test_relations_follow_the_measure(open_report: Open) -> None:
    opened = open_report()
    opened.figure("outcomes")
    assert "10 to 12 combinations" in opened.page.inner_text("#figure-outcomes .note")
    opened.figure("outcome")
    note = opened.page.locator("#figure-outcome .note")
    assert "6 combinations" in note.inner_text()
    opened.page.fill("#filter", "and sift")
    opened.page.locator("#figure-outcome .note", has_text="3 combinations").wait_for()


def test_clouds_are_light_on_paper(open_report: Open) -> None:
    opened = open_report(color_scheme="dark", plotly=False)
    opened.page.locator("#clouds").scroll_into_view_if_needed()
    corner = (
        "[...document.querySelector('canvas[data-side=left]').getContext('2d')"
        ".getImageData(2, 2, 1, 1).data].slice(0, 3)"
    )
    assert max(opened.page.evaluate(corner)) < 60
    opened.page.evaluate("window.dispatchEvent(new Event('beforeprint'))")
    assert opened.page.evaluate(corner) == [255, 255, 255]
    opened.page.evaluate("window.dispatchEvent(new Event('afterprint'))")
    assert max(opened.page.evaluate(corner)) < 60


def test_who_wants_no_motion_is_offered_none(open_report: Open) -> None:
    opened = open_report(reduced_motion="reduce", plotly=False)
    assert opened.page.locator("#turn-clouds").is_hidden()
    assert opened.page.get_by_role("button", name="Turn to the left").is_visible()
