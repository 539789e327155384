"""The file: complete in itself, and nothing in the data can break out of its place."""

from __future__ import annotations

import base64
import gzip
import re
from html.parser import HTMLParser
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from aerocues import Results
from aerocues.report.page import page_of, payload_text
from aerocues.report.report import write_report
from tests.report.decoding import payload_in
from tests.report.made_up import folder_of, measured

NASTY = '<img src=x onerror="alert(1)">'
END = "</script><script>alert(1)</script><!--"


class Elements(HTMLParser):
    """Counts elements and collects where they point to."""

    def __init__(self) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.targets: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.targets += [value for name, value in attrs if name in ("src", "href") and value]


def elements_of(page: str) -> Elements:
    found = Elements()
    found.feed(page)
    return found


@pytest.fixture(scope="module")
def page(flight: Results, tmp_path_factory: pytest.TempPathFactory) -> Path:
    output = tmp_path_factory.mktemp("page") / "report.html"
    return write_report(flight, output, title=f"{NASTY} & {END}", resamples=50)


def test_the_page_needs_nothing_else(page: Path) -> None:
    found = elements_of(page.read_text(encoding="utf-8"))
    assert all(re.match(r"#|data:", target) for target in found.targets)
    assert "link" not in found.tags or all("data:" in target for target in found.targets[:1])
    assert page.stat().st_size < 15e6


def test_a_policy_forbids_requests(page: Path) -> None:
    policy = re.search(r'Content-Security-Policy" content="([^"]+)"', page.read_text())
    assert policy is not None
    assert "default-src 'none'" in policy[1]
    assert "http" not in policy[1]
    assert "connect-src" not in policy[1]


def test_titles_are_text(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    assert NASTY not in text
    assert "<title>&lt;img src=x" in text
    assert payload_in(page)["title"] == f"{NASTY} & {END}"


def test_names_in_the_data_end_no_element(tmp_path: Path) -> None:
    plain = folder_of(measured(pairs=2), tmp_path / "plain")
    nasty = folder_of(
        measured(pairs=2, dataset=END, machine=NASTY, message=END, image_1=NASTY, sequence="a"),
        tmp_path / "nasty",
    )
    expected = write_report(plain, tmp_path / "plain.html", resamples=50)
    written = write_report(nasty, tmp_path / "nasty.html", resamples=50)
    tags = [elements_of(each.read_text(encoding="utf-8")).tags for each in (expected, written)]
    assert tags[0] == tags[1]
    [entry] = payload_in(written)["entries"]
    assert (entry["dataset"], entry["machine"]) == (END, NASTY)
    assert entry["pairs"][0]["image_1"] == NASTY


@given(st.dictionaries(st.text(), st.text()))
def test_payloads_hold_no_tag(facts: dict[str, str]) -> None:
    assert "<" not in payload_text(facts)


def test_placeholders_in_the_data_stay_as_they_are(flight: Results) -> None:
    text = page_of({"title": "{{style}}", "name": "{{plotly}} {{app}} {{payload}}"})
    assert "<title>{{style}}</title>" in text
    assert '"{{plotly}} {{app}} {{payload}}"' in text
    packed = re.search(r'id="plotly">([^<]+)<', text)
    assert packed is not None
    assert b"Plotly" in gzip.decompress(base64.b64decode(packed[1]))


def test_the_program_stands_in_a_scope_of_its_own() -> None:
    text = page_of({"title": ""})
    assert text.count('(() => {\n"use strict";\n') == 1
    assert len(elements_of(text).tags) < 40
