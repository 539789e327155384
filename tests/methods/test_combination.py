from __future__ import annotations

import pickle

import pytest
from hypothesis import given
from hypothesis import strategies as st

from aerocues.errors import SelectionError
from aerocues.methods.combination import Combination
from aerocues.methods.registry import opencv_methods

NAMES = st.from_regex(r"[A-Z0-9_]{1,12}", fullmatch=True)
COMBINATIONS = st.builds(Combination, NAMES, NAMES, NAMES, NAMES)


@given(COMBINATIONS)
def test_text_is_parsed_back_exactly_in_any_case(combination: Combination) -> None:
    text = str(combination)
    for spelling in (text, text.lower(), text.title(), f"  {text}\n"):
        assert Combination.parse(spelling) == combination
    assert pickle.loads(pickle.dumps(combination)) == combination


def test_every_declared_combination_is_parsed_back() -> None:
    for combination in opencv_methods().combinations():
        assert Combination.parse(str(combination).lower()) == combination


@given(st.text(max_size=40))
def test_parsing_any_text_gives_a_combination_or_a_selection_error(text: str) -> None:
    try:
        combination = Combination.parse(text)
    except SelectionError:
        return
    assert str(combination) == text.strip().upper()


@pytest.mark.parametrize(
    "text",
    ["", "ORB", "ORB-ORB-HAM", "ORB-ORB-HAM-BF-BF", "ORB--HAM-BF", "ORB-ORB-HAM-*", "Ö-A-B-C"],
)
def test_malformed_text_is_refused(text: str) -> None:
    with pytest.raises(SelectionError):
        Combination.parse(text)


@given(st.lists(COMBINATIONS, max_size=6))
def test_combinations_sort_by_their_parts(combinations: list[Combination]) -> None:
    parts = [(c.detector, c.descriptor, c.norm, c.matcher) for c in sorted(combinations)]
    assert parts == sorted(parts)
