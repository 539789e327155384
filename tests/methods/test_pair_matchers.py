"""Pair matchers: how they are named, chosen and counted, and what they may return."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from aerocues.errors import SelectionError
from aerocues.methods import plugins
from aerocues.methods.combination import Combination
from aerocues.methods.counting import count_combinations, count_on_request
from aerocues.methods.explanation import explain
from aerocues.methods.pair_matching import ArrayPairMatcher
from aerocues.methods.plugins import installed_methods, register, register_class
from aerocues.methods.registry import Methods, opencv_methods
from aerocues.methods.selection import select, select_one

FOLLOW = Combination("FOLLOW", "NONE", "NONE", "FOLLOW")


@pytest.fixture
def following(monkeypatch: pytest.MonkeyPatch) -> Methods:
    monkeypatch.setattr(plugins, "_REGISTERED", {})
    register_class("tests.methods.following:Follow")
    return installed_methods()


def test_the_name_alone_is_a_combination(following: Methods) -> None:
    assert select_one(following, "follow") == FOLLOW
    assert select_one(following, str(FOLLOW)) == FOLLOW
    assert select(following, "FOLLOW-*,FOL*") == [FOLLOW]
    assert FOLLOW in select(following)
    assert following.parameters(FOLLOW)["matcher"][2] == {"corners": 2000}  # type: ignore[index]
    assert following.matchers["FOLLOW"].upright
    assert following.pair_matchers[-1] == "FOLLOW"


def test_it_is_one_more_combination(following: Methods) -> None:
    before, after = count_combinations(opencv_methods()), count_combinations(following)
    assert (before.declared, before.runnable, before.meaningful) == (784, 467, 340)
    assert (after.declared, after.runnable, after.meaningful) == (785, 468, 341)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("follow", "FOLLOW-NONE-NONE-FOLLOW runs"),
        ("SIFT-SIFT-L2-FOLLOW", "cannot run: FOLLOW is a pair matcher and compares no"),
        ("PIXELMAP-NONE-NONE-FOLLOW", "cannot run: PIXELMAP is a pair matcher, too"),
        ("SIFT-NONE-NONE-FOLLOW", "SIFT-NONE-NONE-FOLLOW runs"),
        ("FOLLOW-SIFT-L2-BF", "cannot run: FOLLOW is a pair matcher and detects nothing"),
        ("SIFT-NONE-L2-BF", "cannot run: BF compares descriptors"),
        ("SIFT-SIFT-NONE-BF", "cannot run: BF compares descriptors"),
    ],
)
def test_its_parts_fit_nothing_else(following: Methods, text: str, words: str) -> None:
    assert words in explain(text, following)


def test_names_that_are_taken(following: Methods) -> None:
    for kind, name in (("pair_matcher", "ORB"), ("pair_matcher", "BF"), ("descriptor", "NONE")):
        with pytest.raises(SelectionError):
            register(kind, name, "tests.methods.following:Follow")


def test_what_is_on_request_is_named_or_asked_for_by_its_set() -> None:
    methods = opencv_methods()
    usual, asked = select(methods), select(methods, "*,+exact")
    assert len(usual) == 340
    assert {each.matcher for each in asked} == {"BF", "FLANN", "EXACT"}
    assert [str(each) for each in select(methods, "SIFT-SIFT-*,+exact,!*-BF")] == [
        "SIFT-SIFT-L2-FLANN",
        "SIFT-SIFT-L2-EXACT",
    ]
    assert count_on_request(methods)["exact"].meaningful == len(asked) - len(usual)
    with pytest.raises(SelectionError, match="exact"):
        select(methods, "*,+nothing")


class Returns:
    def __init__(self, result: Any) -> None:
        self.result = result

    def match_pair(self, image_1: Any, image_2: Any) -> Any:
        return self.result


TWO = np.array([[1.0, 2.0], [3.0, 4.0]])
IMAGE = np.zeros((20, 20, 3), np.uint8)


def read(result: Any) -> Any:
    stage = ArrayPairMatcher(Returns(result))
    return stage.read(stage.call(IMAGE, IMAGE))


def test_positions_are_read_with_and_without_scores() -> None:
    found = read((TWO, TWO + 1))
    assert found.points_2.tolist() == [[2, 3], [4, 5]]
    assert found.points_1.dtype == np.float32
    assert found.scores.tolist() == [0, 0]
    assert read([TWO, TWO, [0.5, 1]]).scores.tolist() == [0.5, 1]
    unmapped = TWO + np.array([[np.nan, 0], [0, 0]])
    assert read((TWO, unmapped)).points_1.tolist() == [[3, 4]]


@pytest.mark.parametrize(
    "result",
    [None, TWO, (TWO,), (TWO, TWO[:1]), (TWO[0], TWO[0]), (TWO, TWO, [1.0]), (TWO.T[:, :1], TWO)],
)
def test_what_is_no_pair_of_positions_is_caught(result: Any) -> None:
    with pytest.raises((TypeError, ValueError)):
        read(result)
