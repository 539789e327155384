"""Words of the page mean what the glossary says."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from aerocues.report.words import WORDS


def first_sentence(text: str) -> str:
    """The first sentence of an entry of the glossary, without marks and links."""
    plain = re.sub(r" \(\[[^)]*\)\)| \([^)]*\[[^)]*\)[^)]*\)", "", " ".join(text.split()))
    plain = re.sub(r"[`*]", "", plain)
    return plain.split(". ")[0].removesuffix(".") + "."


def test_they_are_those_of_the_glossary(repository: Path) -> None:
    glossary = (repository / "docs" / "glossary.md").read_text(encoding="utf-8")
    entries = re.findall(r"^### (.+)\n\n((?:.+\n)+)", glossary, re.MULTILINE)
    meanings = {title.lower(): first_sentence(text) for title, text in entries}
    assert {word: meanings.get(word.lower()) for word in WORDS} == WORDS


@pytest.mark.slow
def test_a_word_is_explained_where_it_stands_first(open_report: Callable[..., Any]) -> None:
    page = open_report("#method").page
    [words] = page.locator("summary", has_text="Words (1)").all()
    words.click()
    meaning = page.get_by_role("cell", name="a meaning").text_content()
    explained = page.locator("abbr")
    assert explained.count() > 0
    assert {each.get_attribute("title") for each in explained.all()} == {meaning}
    assert {str(each.text_content()).lower() for each in explained.all()} <= {"inlier", "inliers"}
