"""Scores by component, by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from aerocues.scoring import ScoreSettings, score
from aerocues.scoring.hierarchy import hierarchy
from tests.scoring.tables import table_of

NAN = float("nan")


def test_means_by_hand() -> None:
    # With one criterion and alpha = 1, the scores are 0, 0.5, 1 and 0.25.
    table = table_of([[[0.0]], [[2.0]], [[4.0]], [[1.0]]], names=["a-x", "a-y", "b-x", "b-y"])
    table = replace(table, components={"first": tuple("aabb"), "second": tuple("xyxy")})
    found = hierarchy(score(table, ScoreSettings(alpha=1)))
    assert list(found) == ["first", "second"]
    assert found["first"].columns == [
        "name",
        "mean",
        "max",
        "standard_deviation",
        "alternatives",
        "evaluations",
        "best",
    ]
    assert found["first"].rows() == [
        ("b", 0.625, 1.0, 0.375, 2, 2, "b-x"),
        ("a", 0.25, 0.5, 0.25, 2, 2, "a-y"),
    ]
    assert found["second"]["mean"].to_list() == [0.5, 0.375]
    assert found["second"]["best"].to_list() == ["b-x", "a-y"]


def test_evaluations_are_what_was_measured() -> None:
    values = np.ones((3, 4, 2))
    values[0, :2] = NAN
    failed = np.zeros(values.shape, dtype=bool)
    failed[0, 0] = True
    table = replace(table_of(values, failed=failed), components={"kind": tuple("aab")})
    found = hierarchy(score(table))["kind"]
    assert dict(found.select("name", "evaluations").iter_rows()) == {"a": 7, "b": 4}


def test_what_has_no_score_takes_no_part() -> None:
    table = table_of([[[NAN]], [[2.0]], [[4.0]]])
    table = replace(table, components={"kind": tuple("abb")})
    found = hierarchy(score(table, ScoreSettings(failures="omit")))["kind"]
    assert found["name"].to_list() == ["b"]


def test_equal_means_stand_by_name() -> None:
    table = replace(table_of(np.ones((3, 1, 1))), components={"kind": ("c", "a", "b")})
    assert hierarchy(score(table))["kind"]["name"].to_list() == ["a", "b", "c"]


def test_without_components_there_is_nothing() -> None:
    assert hierarchy(score(table_of(np.ones((3, 1, 1))))) == {}


@pytest.mark.parametrize("order", [[0, 1, 2, 3], [3, 1, 0, 2]])
def test_the_best_is_that_of_the_highest_score(order: list[int]) -> None:
    values = np.array([[[0.0]], [[2.0]], [[4.0]], [[1.0]]])
    table = replace(table_of(values), components={"kind": tuple("aaaa")})
    found = hierarchy(score(table.with_alternatives(order)))["kind"]
    assert found["best"].to_list() == ["a2"]
