"""What the page opens, compares and limits: drawer, limits beside the filter, tools of clouds."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from tests.report.conftest import Opened
from tests.report.small_payload import names_of

Open = Callable[..., Opened]
NAMES = names_of()


def test_a_row_opens_and_is_compared_with_a_pinned_one(open_report: Open) -> None:
    opened = open_report()
    opened.page.click(f'#ranking button[data-combination="{NAMES[0]}"]')
    assert opened.page.inner_text("#drawer-title") == NAMES[0]
    assert opened.page.locator("#ranking tr.picked th").inner_text() == NAMES[0]
    opened.page.click("text=Pin to compare")
    opened.page.keyboard.press("Escape")
    opened.page.click(f'#ranking button[data-combination="{NAMES[4]}"]')
    assert opened.page.locator("#drawer .details > h3").all_inner_texts() == [NAMES[0], NAMES[4]]
    opened.page.click("#drawer .panel-title button")
    opened.figure("heat")
    opened.page.locator(f'#figure-heat [data-combination="{NAMES[1]}"]').click()
    assert NAMES[1] in opened.page.inner_text("#drawer-title")


def test_a_point_opens_and_is_marked_in_other_figures(open_report: Open) -> None:
    opened = open_report()
    opened.figure("pareto")
    point = opened.page.locator("#figure-pareto .points path").first
    point.scroll_into_view_if_needed()
    box = point.bounding_box()
    assert box is not None
    opened.page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    opened.page.wait_for_selector("#drawer:visible")
    assert opened.page.inner_text("#drawer-title") in NAMES
    assert opened.fragment().startswith("decide.pick=")


def _seconds_of_pareto(opened: Opened) -> list[str]:
    """The words at the ticks of times, which do not depend on the colours."""
    texts = opened.page.locator("#figure-pareto svg > g:first-of-type text")
    return [text for text in texts.all_text_contents() if text.endswith(" s")]


def test_dragging_over_points_shows_them_larger(open_report: Open) -> None:
    opened = open_report()
    opened.figure("pareto")
    drawing = opened.page.locator("#figure-pareto svg")
    whole = drawing.text_content()
    box = drawing.bounding_box()
    assert box is not None
    opened.page.mouse.move(box["x"] + 200, box["y"] + 100)
    opened.page.mouse.down()
    opened.page.mouse.move(box["x"] + 260, box["y"] + 150)
    opened.page.mouse.up()
    assert drawing.text_content() != whole
    assert not opened.page.locator("#drawer").is_visible()
    larger, zoomed = drawing.text_content(), _seconds_of_pareto(opened)
    colour = opened.page.locator("#figure-pareto select").last
    chosen = colour.input_value()
    colour.select_option(index=2)
    opened.page.wait_for_function(
        "before => document.querySelector('#figure-pareto svg').textContent !== before",
        arg=larger,
    )
    assert _seconds_of_pareto(opened) == zoomed
    colour.select_option(chosen)
    opened.page.wait_for_function(
        "before => document.querySelector('#figure-pareto svg').textContent === before",
        arg=larger,
    )
    opened.page.mouse.dblclick(box["x"] + 150, box["y"] + 300)
    assert drawing.text_content() == whole


def test_a_drag_that_is_no_zoom_opens_nothing(open_report: Open) -> None:
    opened = open_report()
    opened.figure("pareto")
    box = opened.page.locator("#figure-pareto .points path").first.bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    opened.page.mouse.move(x - 12, y)
    opened.page.mouse.down()
    opened.page.mouse.move(x, y)
    opened.page.mouse.up()
    assert not opened.page.locator("#drawer").is_visible()
    opened.page.mouse.click(x, y)
    assert opened.page.locator("#drawer").is_visible()


def test_the_first_screen_needs_no_plotly(open_report: Open) -> None:
    opened = open_report()
    opened.page.add_init_script("delete window.DecompressionStream")
    opened.page.reload()
    opened.figure("pareto")
    opened.figure("map")
    opened.figure("heat")
    assert opened.page.locator("#figure-heat .main-svg").count() == 1
    opened.figure("weights")
    assert "too old to draw" in opened.page.inner_text("#figure-weights .nothing")


def test_damage_of_plotly_is_not_called_an_old_browser(
    open_report: Open, report: Path, tmp_path: Path
) -> None:
    file = tmp_path / "damaged.html"
    text = report.read_text(encoding="utf-8").replace('id="plotly">', 'id="plotly">-')
    file.write_text(text, encoding="utf-8")
    opened = open_report(file=file)
    opened.figure("weights")
    assert "damaged" in opened.page.inner_text("#figure-weights .nothing")


def test_limits_keep_what_is_between_them_and_the_worst(open_report: Open) -> None:
    opened = open_report(plotly=False)
    scores = opened.page.evaluate("JSON.parse(payload.textContent).entries[0].score.score")
    inside = [name for name, score in zip(NAMES, scores, strict=True) if 0.3 <= score <= 0.6]
    opened.page.click("#limits-summary")
    opened.page.fill("#limit-min", "0.3")
    opened.page.fill("#limit-max", "0.6")
    assert sorted(opened.rows()) == sorted(inside)
    opened.page.fill("#limit-worst", "2")
    assert sorted(opened.rows()) == sorted(inside[-2:])
    assert opened.page.inner_text("#limits-summary") == "Limits (on)"
    opened.page.click("#filter-clear")
    assert len(opened.rows()) == len(NAMES)


def test_clouds_fly_to_a_camera_and_are_saved(open_report: Open, tmp_path: Path) -> None:
    opened = open_report(plotly=False)
    opened.page.locator("#clouds").scroll_into_view_if_needed()
    canvas = opened.page.locator("#clouds canvas").first
    before = canvas.evaluate("each => each.toDataURL()")
    opened.page.select_option("#fly-to", "1.png")
    assert canvas.evaluate("each => each.toDataURL()") != before
    assert "1.png" in opened.page.inner_text("#clouds .photo")
    with opened.page.expect_download() as download:
        opened.page.click("text=PLY, left")
    file = tmp_path / "cloud.ply"
    download.value.save_as(file)
    lines = file.read_text().splitlines()
    assert lines[:3] == ["ply", "format ascii 1.0", "element vertex 200"]
    assert len(lines) == 200 + lines.index("end_header") + 1
