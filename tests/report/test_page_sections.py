"""What the sections of the page show, and that nothing in data can break out of its place."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from tests.report.conftest import Opened, written
from tests.report.small_payload import HARMFUL, lone_payload, names_of

Open = Callable[..., Opened]
NAMES = names_of()
FIGURES = (
    "pareto", "map", "heat", "dots", "weights", "components",
    "spread", "pr", "im", "curves", "truth", "truthmatrix",
    "stages", "thousand", "bymethod", "matchers", "machines",
    "criteria", "sensitivity", "agreement", "critical", "slopes", "rankings",
    "c2c", "outcome", "outcomes",
)  # fmt: skip


OF_MODELS = ("c2c", "outcome", "outcomes")
OF_FLIGHTS = ("map",)


def test_every_figure_is_drawn_and_all_text_stays_text(open_report: Open) -> None:
    opened = open_report()
    found = opened.page.eval_on_selector_all(
        "figure.figure", "all => all.map(each => each.id.replace('figure-', ''))"
    )
    assert found == list(FIGURES)
    for name in FIGURES:
        opened.figure(name)
        assert not opened.page.locator(f"#figure-{name} .nothing").count(), name
    for summary in opened.page.locator("#method summary").all():
        summary.click()
    assert HARMFUL in opened.page.inner_text("#method")
    assert HARMFUL in opened.page.inner_text("h1")
    assert opened.page.evaluate("window.harmed") is None
    assert opened.page.locator("img").count() == 0
    assert "<b>MINE" in str(opened.page.text_content("#figure-heat .plot"))


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_a_table_that_goes_on_has_a_shadow_at_its_edge(open_report: Open, scheme: str) -> None:
    opened = open_report(viewport={"width": 500, "height": 900}, color_scheme=scheme, plotly=False)
    table = opened.page.locator("#ranking").locator("xpath=ancestor::*[@class='scroll']")
    before = _right_edge(table.screenshot())
    table.evaluate("each => { each.scrollLeft = each.scrollWidth; }")
    assert abs(before - _right_edge(table.screenshot())) > 15


def _right_edge(picture: bytes) -> float:
    """How bright the last columns of a picture are."""
    from PIL import Image

    return float(np.median(np.asarray(Image.open(io.BytesIO(picture)).convert("L"))[:, -2:]))


def test_the_answer_comes_first(open_report: Open) -> None:
    opened = open_report(plotly=False)
    words = opened.page.inner_text("#verdict")
    assert re.search(
        r"^Take SIFT-SIFT-L2-BF\b.*\b80\s%.* 1,000 resamples .* 8 pairs; 2 others", words, re.S
    )
    assert "12 combinations" in opened.page.inner_text("#facts")
    opened.page.fill("#filter", "orb")
    words = opened.page.inner_text("#verdict")
    assert words.startswith("Take ORB-ORB-HAM-BF")
    assert "Among the 4 combinations that match the filter" in words


def test_the_table_is_sorted_by_its_headings(open_report: Open) -> None:
    opened = open_report(plotly=False)
    assert opened.rows()[0] == "SIFT-SIFT-L2-BF"
    heading = '#ranking th[data-key="combination"]'
    opened.page.click(f"{heading} button")
    assert opened.rows() == sorted(NAMES, key=str.casefold)
    assert opened.page.get_attribute(heading, "aria-sort") == "ascending"
    opened.page.click(f"{heading} button")
    assert opened.rows() == sorted(NAMES, key=str.casefold, reverse=True)
    # The best has no p: what has no value comes last, whichever way.
    for _ in range(2):
        opened.page.click('#ranking th[data-key="p_value"] button')
        assert opened.rows()[-1] == "SIFT-SIFT-L2-BF"


def test_columns_are_chosen(open_report: Open) -> None:
    opened = open_report(plotly=False)
    opened.page.get_by_text("Columns", exact=True).first.click()
    opened.page.get_by_label("Detector", exact=True).check()
    assert opened.page.locator('#ranking th[data-key="detector"]').count() == 1
    opened.page.get_by_label("p", exact=True).uncheck()
    assert opened.page.locator('#ranking th[data-key="p_value"]').count() == 0
    opened.page.get_by_text("Default columns").first.click()
    assert opened.page.locator('#ranking th[data-key="p_value"]').count() == 1


def _saved(opened: Opened, click: str) -> tuple[str, bytes]:
    with opened.page.expect_download() as waiting:
        opened.page.click(click)
    return waiting.value.suggested_filename, Path(waiting.value.path()).read_bytes()


def test_the_table_is_saved_as_it_is_filtered(open_report: Open) -> None:
    opened = open_report("#q=daisy&sort=-combination", plotly=False)
    name, content = _saved(opened, "#save-ranking")
    rows = list(csv.DictReader(io.StringIO(content.decode())))
    assert name.endswith("ranking.csv")
    assert [row["combination"] for row in rows] == [
        "SIFT-DAISY-L2-BF", "GFTT_H-DAISY-L2-BF", "GFTT-DAISY-L2-BF"]  # fmt: skip
    assert 0 <= float(rows[0]["score_low"]) < float(rows[0]["score"]) < 1


def test_figures_are_saved(open_report: Open) -> None:
    opened = open_report("#theme=dark")
    opened.figure("pareto")
    name, content = _saved(opened, '#figure-pareto button:text-is("SVG")')
    assert name.endswith("speed-against-quality.svg")
    assert content.startswith(b"<svg")
    assert b"SIFT-SIFT-L2-BF" in content
    assert _saved(opened, '#figure-pareto button:text-is("PNG")')[1].startswith(b"\x89PNG")
    table = _saved(opened, '#figure-pareto button:text-is("CSV")')[1].decode()
    rows = list(csv.reader(io.StringIO(table)))
    assert rows[0] == ["series", "x", "y", "value_or_name"]
    assert sorted(row[3] for row in rows[1:]) == sorted(NAMES)


def test_matches_are_drawn_and_counted(open_report: Open) -> None:
    opened = open_report(plotly=False)
    panel = opened.page.locator(".panel-of-matches").first
    panel.scroll_into_view_if_needed()
    wrong = "10 inliers, of which 5 are wrong by the reference"
    panel.get_by_text(re.compile(rf"2nd match .* {wrong}, 10 outliers")).wait_for()
    assert "SIFT-SIFT-L2-BF" in panel.inner_text()
    opened.page.get_by_role("checkbox", name="Outliers").uncheck()
    opened.page.get_by_role("checkbox", name="Keypoints").check()
    layers = rf"3rd keypoint .* 2nd match .* {wrong}, 0 outliers"
    panel.get_by_text(re.compile(layers)).wait_for()
    assert "picture.outliers=no" in opened.fragment()
    opened.page.get_by_role("combobox", name="Images").select_option("5")
    panel.get_by_text("no picture").wait_for()


def test_without_models_the_section_says_how_to_make_them(
    open_report: Open, tmp_path: Path
) -> None:
    opened = open_report(file=written(lone_payload(), tmp_path / "lone.html"))
    assert "aerocues reconstruct DATASET" in opened.page.inner_text("#no-models")
    for hidden in ("#modelled", "#clouds", "#figure-c2c", "#figure-outcomes"):
        assert opened.page.locator(hidden).is_hidden()


def test_one_combination_on_one_pair_is_a_report_too(open_report: Open, tmp_path: Path) -> None:
    opened = open_report(file=written(lone_payload(), tmp_path / "lone.html"))
    assert "only combination" in opened.page.inner_text("#verdict")
    assert opened.page.locator("#entry").count() == 0
    for name in FIGURES:
        if name not in OF_MODELS + OF_FLIGHTS:
            opened.figure(name)
    assert opened.page.locator("#pictures").is_hidden()
