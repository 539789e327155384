"""The score of a tiny table by hand."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from aerocues.errors import ScoreError
from aerocues.scoring import DecisionTable, ScoreSettings, score
from aerocues.scoring.cues import rank
from tests.scoring.tables import table_of

NAN = float("nan")
BY_VARIANCE = ScoreSettings(weights=("variance",), alpha=0.5)

# Two repeats of a benefit and a cost, both between 0 and 16.
#   benefit: means 16 4 0, so z = 1 1/4 0 and x = 1 1/2 0, variance 1/6 = 12/72
#   cost: means 16 7 12, so z = 0 9/16 1/4 and x = 0 3/4 1/2, variance 7/72
VALUES = [
    [[16, 16], [16, 16]],
    [[4, 0], [4, 14]],
    [[0, 8], [0, 16]],
]


def test_score_by_hand() -> None:
    scores = score(table_of(VALUES, costs=[1]), BY_VARIANCE)
    np.testing.assert_allclose(scores.means, [[16, 16], [4, 7], [0, 12]])
    np.testing.assert_allclose(scores.normalised, np.array([[1, 0], [0.5, 0.75], [0, 0.5]]))
    np.testing.assert_allclose(scores.weights, [12 / 19, 7 / 19])
    np.testing.assert_allclose(scores.scores, [12 / 19, 11.25 / 19, 3.5 / 19])
    assert scores.ranks.tolist() == [1, 2, 3]
    assert scores.order.tolist() == [0, 1, 2]
    assert scores.best == 0


def test_the_power_comes_after_the_inversion_of_a_cost() -> None:
    scores = score(table_of(VALUES, costs=[1]), replace(BY_VARIANCE, alpha=2))
    np.testing.assert_allclose(scores.normalised[:, 1], [0, (9 / 16) ** 2, 1 / 16])


def test_a_failed_repeat_left_out() -> None:
    values = np.array(VALUES, dtype=float)
    values[2, 1] = NAN
    scores = score(table_of(values, costs=[1]), replace(BY_VARIANCE, failures="omit"))
    # The mean cost of the last is that of its first repeat, 8: it gains by failing.
    np.testing.assert_allclose(scores.means[2], [0, 8])
    np.testing.assert_allclose(scores.normalised[2], [0, math.sqrt(0.5)])


def test_a_failed_repeat_as_the_worst() -> None:
    values = np.array(VALUES, dtype=float)
    values[2, 1] = NAN
    scores = score(table_of(values, costs=[1]), BY_VARIANCE)
    # 16 is the worst cost and 0 the worst benefit: what it had before it failed.
    expected = score(table_of(VALUES, costs=[1]), BY_VARIANCE)
    np.testing.assert_allclose(scores.scores, expected.scores)
    np.testing.assert_allclose(scores.means[2], [0, 8])


def test_a_repeat_that_was_not_measured_costs_nothing() -> None:
    values = np.array(VALUES, dtype=float)
    values[2, 1] = NAN
    table = table_of(values, costs=[1], failed=np.zeros(values.shape, dtype=bool))
    worst, omit = (score(table, ScoreSettings(failures=each)) for each in ("worst", "omit"))
    np.testing.assert_allclose(worst.scores, omit.scores)


def _framed(seed: int, share: float) -> tuple[DecisionTable, DecisionTable]:
    """A table with failures, and the same with the worst values in their place.

    The first two alternatives hold the smallest and largest values in every repeat.
    """
    generator = np.random.default_rng(seed)
    values = generator.uniform(size=(6, 5, 3))
    values[0], values[1] = 0, 1
    failed = generator.uniform(size=values.shape) < share
    failed[:2] = False
    costs = [1]
    worst = np.where(np.isin(np.arange(3), costs), 1.0, 0.0)
    return (
        table_of(np.where(failed, NAN, values), costs),
        table_of(np.where(failed, worst, values), costs),
    )


@given(st.integers(0, 10_000), st.sampled_from([0.1, 0.5, 0.9]))
def test_a_failure_equals_the_worst_value_put_in_its_place(seed: int, share: float) -> None:
    with_failures, substituted = _framed(seed, share)
    np.testing.assert_allclose(
        score(with_failures).scores, score(substituted).scores, rtol=0, atol=1e-12
    )


def test_bounds_are_those_of_single_repeats_not_of_means() -> None:
    # Means 5 and 5; single repeats reach from 0 to 10.
    scores = score(table_of([[[0], [10]], [[4], [6]]]), ScoreSettings(alpha=1))
    np.testing.assert_allclose(scores.scores, [0.5, 0.5])
    assert scores.ranks.tolist() == [1, 1]


def test_an_alternative_that_lacks_a_criterion_has_no_score() -> None:
    values = np.array(VALUES, dtype=float)
    values[1, :, 0] = NAN
    scores = score(table_of(values, costs=[1]), replace(BY_VARIANCE, failures="omit"))
    assert np.isnan(scores.scores).tolist() == [False, True, False]
    assert np.isnan(scores.ranks).tolist() == [False, True, False]
    assert scores.order.tolist() == [0, 2]
    # Its cost counts for the bounds: 0, in its first repeat, is still the best.
    np.testing.assert_allclose(scores.normalised[2], [0, 0.5])


def test_no_alternative_with_all_criteria_is_refused() -> None:
    table = table_of([[[1, NAN]], [[NAN, 2]]])
    with pytest.raises(ScoreError):
        score(table, ScoreSettings(failures="omit"))


def test_equal_scores_share_the_best_rank_and_stand_by_name() -> None:
    table = table_of([[[1.0]], [[3.0]], [[3.0]], [[2.0]]], names=["d", "c", "b", "a"])
    scores = score(table)
    assert scores.ranks.tolist() == [4, 1, 1, 3]
    assert [table.alternatives[position] for position in scores.order] == ["b", "c", "a", "d"]


def test_ranks_along_the_last_axis() -> None:
    ranks = rank(np.array([[0.1, 0.5, NAN, 0.5 + 1e-15], [0.3, 0.2, 0.1, 0.0]]))
    np.testing.assert_array_equal(ranks, [[3, 1, NAN, 1], [1, 2, 3, 4]])


@pytest.mark.parametrize("value", [0.1, 0.7, 12.3, 1e9])
@pytest.mark.parametrize("costs", [[], [0]])
def test_rounding_of_a_mean_leaves_nothing_of_the_worst(value: float, costs: list[int]) -> None:
    # (0.1 + 0.1 + 0.1) / 3 is not 0.1, and the rest to the power 0.1 would be 0.02.
    for repeats in (3, 7, 35):
        values = np.repeat([[[value]], [[value + 0.5]]], repeats, axis=1)
        scores = score(table_of(values, costs), ScoreSettings(alpha=0.1))
        np.testing.assert_allclose(np.sort(scores.scores), [0, 1], rtol=0, atol=1e-12)


def test_bounds_above_zero_and_the_first_repeat_by_hand() -> None:
    nan = float("nan")
    values = [[[0.0], [4.0]], [[2.0], [2.0]], [[10.0], [6.0]], [[nan], [8.0]]]
    settings = ScoreSettings(alpha=1, failures="omit", bounds="positive", needs_first=True)
    # From 2, the least above 0, to 10, which the last one counts for without a score.
    np.testing.assert_allclose(score(table_of(values), settings).scores, [0, 0, 0.75, nan])
    every = replace(settings, needs_first=False)
    np.testing.assert_allclose(score(table_of(values), every).scores, [0, 0, 0.75, 0.75])
    measured = replace(every, bounds="measured")
    np.testing.assert_allclose(score(table_of(values), measured).scores, [0.2, 0.2, 0.8, 0.8])
