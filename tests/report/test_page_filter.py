"""The filter of the page: words, chips, what they keep, and the state in the address."""

from __future__ import annotations

from collections.abc import Callable
from urllib.parse import parse_qs

from tests.report.conftest import Opened
from tests.report.small_payload import names_of

Open = Callable[..., Opened]
NAMES = names_of()


WORDS = [
    ("", NAMES),
    ("orb", [name for name in NAMES if "ORB" in name.split("-")]),
    ("orb -flann", [n for n in NAMES if "ORB" in n.split("-") and "FLANN" not in n]),
    ("and orb -flann", [n for n in NAMES if "ORB" in n.split("-") and "FLANN" not in n]),
    ("ORB Ham BF", [n for n in NAMES if "ORB" in n and n.endswith("HAM-BF")]),
    ("or sift daisy", [n for n in NAMES if {"SIFT", "DAISY"} & set(n.split("-"))]),
    ("not l2", [n for n in NAMES if "L2" not in n]),
    ("or daisy orb not l2", [n for n in NAMES if "ORB" in n.split("-")]),
    ("kaze", ["KAZE-KAZE-L2-BF"]),
    ("gftt", ["GFTT-DAISY-L2-BF"]),
    ("gft", ["GFTT-DAISY-L2-BF", "GFTT_H-DAISY-L2-BF"]),
    ("beb", ["ORB-BEBLID-HAM-BF"]),
    ("sift-sift", ["SIFT-SIFT-L2-BF", "SIFT-SIFT-L2-FLANN"]),
    ("orb-beblid-ham-bf", ["ORB-BEBLID-HAM-BF"]),
    ("constructor", []),
]  # fmt: skip


def test_words_keep_the_combinations_that_they_name(open_report: Open) -> None:
    opened = open_report(plotly=False)
    for words, kept in WORDS:
        opened.page.fill("#filter", words)
        assert opened.page.inner_text("#filter-count") == f"{len(kept)} of {len(NAMES)}", words
        shown = opened.rows() if kept else []
        assert sorted(shown) == sorted(kept), words


def test_a_word_that_nothing_has_is_named(open_report: Open) -> None:
    opened = open_report()
    opened.page.fill("#filter", "orb surf")
    assert "“surf”" in opened.page.inner_text("#filter-help")
    assert "No combination" in opened.page.inner_text("#ranking")
    opened.figure("dots")
    assert "No combination" in opened.page.inner_text("#figure-dots")


def test_chips_keep_any_of_a_kind_and_all_of_the_kinds(open_report: Open) -> None:
    opened = open_report(plotly=False)
    opened.page.click("#methods-summary")
    for code, name in (("detector", "SIFT"), ("detector", "ORB"), ("matcher", "FLANN")):
        opened.page.click(f'.chip[data-code="{code}"][data-name="{name}"]')
    assert sorted(opened.rows()) == ["ORB-ORB-HAM-FLANN", "SIFT-SIFT-L2-FLANN"]
    assert opened.page.get_attribute('.chip[data-name="FLANN"]', "aria-pressed") == "true"
    opened.page.fill("#filter", "orb")
    assert opened.rows() == ["ORB-ORB-HAM-FLANN"]
    opened.page.click("#filter-clear")
    assert opened.page.inner_text("#filter-count") == f"{len(NAMES)} of {len(NAMES)}"
    assert opened.fragment() == ""


def test_the_filter_reaches_figures(open_report: Open) -> None:
    opened = open_report()
    opened.figure("dots")
    opened.page.fill("#filter", "orb -flann")
    opened.page.wait_for_function(
        "() => !document.querySelector('#figure-dots .plot').textContent.includes('SIFT-SIFT')"
    )
    assert "ORB-BEBLID-HAM-BF" in str(opened.page.text_content("#figure-dots .plot"))


def test_the_state_stands_in_the_address_and_comes_back(open_report: Open) -> None:
    opened = open_report()
    opened.page.fill("#filter", "or sift orb")
    opened.page.click("#methods-summary")
    opened.page.click('.chip[data-code="norm"][data-name="L2"]')
    opened.page.keyboard.press("Escape")
    opened.page.click('#ranking th[data-key="precision"] button')
    opened.figure("pareto")
    opened.page.select_option("#figure-pareto select >> nth=0", "total_seconds")
    fragment = opened.fragment()
    assert parse_qs(fragment) == {
        "q": ["or sift orb"],
        "norm": ["L2"],
        "sort": ["-precision"],
        "pareto.x": ["total_seconds"],
    }
    again = open_report(f"#{fragment}")
    assert again.rows() == opened.rows()
    assert again.page.input_value("#filter") == "or sift orb"
    again.figure("pareto")
    assert again.page.input_value("#figure-pareto select >> nth=0") == "total_seconds"


def test_a_changed_address_changes_the_page(open_report: Open) -> None:
    opened = open_report("#q=sift", plotly=False)
    opened.page.evaluate("location.hash = '#q=kaze&theme=dark'")
    opened.page.wait_for_function("() => document.documentElement.dataset.theme === 'dark'")
    assert opened.rows() == ["KAZE-KAZE-L2-BF"]


def test_nonsense_in_the_address_does_no_harm(open_report: Open) -> None:
    opened = open_report(
        "#q=%3Cimg%20src%3Dx%3E&entry=none&sort=-nothing&rows=x&columns=,,&heat.value=zzz"
        "&theme=blue&pareto.colour=__proto__&%E0%A4%A"
    )
    assert "combination begins with" in opened.page.inner_text("#filter-help")
    opened.page.fill("#filter", "")
    opened.figure("heat")
    assert opened.page.input_value("#figure-heat select") == "score"


def test_another_data_set_can_be_chosen(open_report: Open) -> None:
    opened = open_report()
    opened.page.select_option("#entry", "imported")
    assert opened.fragment() == "entry=imported"
    assert "imported" in opened.page.inner_text("#facts")
    opened.figure("curves")
    assert "series" in opened.page.inner_text("#figure-curves")
    opened.figure("stages")
    assert "total" in opened.page.inner_text("#figure-stages .note")
