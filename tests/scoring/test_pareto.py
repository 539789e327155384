"""The Pareto front by hand."""

from __future__ import annotations

import numpy as np
import pytest

from aerocues.errors import ScoreError
from aerocues.scoring import score
from aerocues.scoring.pareto import pareto_front, pareto_of_criteria
from tests.scoring.tables import table_of

NAN = float("nan")


def test_front_by_hand() -> None:
    # The second is below the first, the fourth equals the third, the fifth is below it in one.
    points = np.array([[1, 5], [1, 4], [3, 3], [3, 3], [2, 3], [5, 1], [NAN, 9]])
    assert pareto_front(points).tolist() == [True, False, True, True, False, True, False]


def test_one_point_and_none() -> None:
    assert pareto_front(np.array([[1.0, 2.0]])).tolist() == [True]
    assert pareto_front(np.empty((0, 2))).tolist() == []


def test_front_of_many_by_definition() -> None:
    points = np.round(np.random.default_rng(0).uniform(size=(60, 3)) * 5)
    front = pareto_front(points)
    for position, point in enumerate(points):
        dominated = any((other >= point).all() and (other > point).any() for other in points)
        assert front[position] == (not dominated)


def test_front_of_speed_against_quality() -> None:
    # Quality is a benefit, seconds are a cost: (5, 9), (4, 3), (4, 5) and (1, 1).
    values = np.array([[[5, 9]], [[4, 3]], [[4, 5]], [[1, 1]]])
    scores = score(table_of(values, costs=[1]))
    assert pareto_of_criteria(scores, "c0", "c1").tolist() == [0, 1, 3]
    assert pareto_of_criteria(scores, "c1", "c0").tolist() == [3, 1, 0]


def test_an_unknown_criterion() -> None:
    scores = score(table_of(np.ones((2, 1, 1))))
    with pytest.raises(ScoreError, match=r"'speed'.*\bc0\b"):
        pareto_of_criteria(scores, "c0", "speed")
