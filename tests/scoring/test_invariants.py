"""What must not change a ranking, and what a ranking must never do."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays
from numpy.typing import NDArray

from aerocues.scoring import DecisionTable, Scores, ScoreSettings, score
from aerocues.scoring.aggregation import AGGREGATIONS
from aerocues.scoring.settings import FAILURES
from aerocues.scoring.weights import WEIGHT_METHODS
from tests.scoring.tables import table_of

FEWER = settings(max_examples=60)
SETTINGS = st.builds(
    ScoreSettings,
    alpha=st.sampled_from([0.1, 0.5, 1.0, 2.0]),
    weights=st.lists(st.sampled_from(list(WEIGHT_METHODS)), min_size=1, unique=True).map(tuple),
    aggregation=st.sampled_from(list(AGGREGATIONS)),
    failures=st.sampled_from(FAILURES),
)


@st.composite
def decision_tables(draw: st.DrawFn, share_failed: int = 0) -> DecisionTable:
    """Small tables of whole numbers, so that ties and constants occur."""
    shape = draw(array_shapes(min_dims=3, max_dims=3, min_side=1, max_side=5))
    values = draw(arrays(np.float64, shape, elements=st.integers(-9, 9).map(float)))
    costs = draw(st.lists(st.integers(0, shape[2] - 1), unique=True))
    lost = draw(arrays(np.bool_, shape, elements=st.integers(1, 10).map(share_failed.__ge__)))
    lost[0] = False
    return table_of(np.where(lost, np.nan, values), costs)


def assert_same(one: Scores, other: Scores, order: NDArray[np.int64] | None = None) -> None:
    """Scores and ranks agree; `order` tells where the alternatives of `one` are in `other`."""
    positions = np.arange(len(one.scores)) if order is None else order
    np.testing.assert_allclose(one.scores, other.scores[positions], rtol=0, atol=1e-9)
    np.testing.assert_array_equal(one.ranks, other.ranks[positions])


@FEWER
@given(decision_tables(share_failed=3), SETTINGS)
def test_scores_and_weights_stay_in_their_range(
    table: DecisionTable, chosen: ScoreSettings
) -> None:
    scores = score(table, chosen)
    known = scores.scores[~np.isnan(scores.scores)]
    assert known.min() >= 0
    assert known.max() <= 1 + 1e-12
    for weights in (*scores.by_method, scores.weights):
        assert weights.min() >= 0
        np.testing.assert_allclose(weights.sum(), 1)


@FEWER
@given(
    decision_tables(share_failed=3),
    SETTINGS,
    st.lists(
        st.tuples(st.floats(1e-6, 1e6), st.floats(-10, 10)).map(tuple), min_size=5, max_size=5
    ),
)
def test_units_of_criteria_have_no_influence(
    table: DecisionTable, chosen: ScoreSettings, units: list[tuple[float, float]]
) -> None:
    factor = np.array([each[0] for each in units[: len(table.criteria)]])
    # Offsets in the new unit: a temperature in Fahrenheit, not in units of 1e12 of them.
    offset = factor * [each[1] for each in units[: len(table.criteria)]]
    changed = replace(table, values=table.values * factor + offset)
    assert_same(score(changed, chosen), score(table, chosen))


@FEWER
@given(decision_tables(share_failed=3), SETTINGS, st.randoms(use_true_random=False))
def test_order_has_no_influence(
    table: DecisionTable, chosen: ScoreSettings, random: object
) -> None:
    generator = np.random.default_rng(random.getrandbits(32))  # type: ignore[attr-defined]
    alternatives, repeats, criteria = (generator.permutation(n) for n in table.values.shape)
    shuffled = DecisionTable(
        alternatives=tuple(table.alternatives[each] for each in alternatives),
        repeats=tuple(table.repeats[each] for each in repeats),
        criteria=tuple(table.criteria[each] for each in criteria),
        values=table.values[np.ix_(alternatives, repeats, criteria)],
        failed=table.failed[np.ix_(alternatives, repeats, criteria)],
        blocks=table.blocks[repeats],
    )
    one, other = score(shuffled, chosen), score(table, chosen)
    assert_same(one, other, alternatives)
    np.testing.assert_allclose(one.weights, other.weights[criteria], rtol=0, atol=1e-9)


@FEWER
@given(decision_tables(), SETTINGS, st.data())
def test_the_dominated_never_outranks_its_dominator(
    table: DecisionTable, chosen: ScoreSettings, data: st.DataObject
) -> None:
    values = table.values
    loss = data.draw(arrays(np.float64, values.shape[1:], elements=st.integers(0, 4).map(float)))
    dominated = values[0] - np.where(table.is_cost, -loss, loss)
    costs = np.flatnonzero(table.is_cost).tolist()
    scores = score(table_of(np.concatenate([values, dominated[None]]), costs), chosen)
    assert scores.ranks[0] <= scores.ranks[-1]


@FEWER
@given(decision_tables(), st.data())
def test_to_fail_never_pays_where_failures_are_the_worst(
    table: DecisionTable, data: st.DataObject
) -> None:
    values = table.values
    lost = data.draw(arrays(np.bool_, values.shape[1:]))
    failing = np.where(lost, np.nan, values[0])
    costs = np.flatnonzero(table.is_cost).tolist()
    scores = score(table_of(np.concatenate([values, failing[None]]), costs))
    assert scores.ranks[0] <= scores.ranks[-1]


@FEWER
@given(decision_tables(), SETTINGS)
def test_an_alternative_with_nothing_changes_no_score(
    table: DecisionTable, chosen: ScoreSettings
) -> None:
    empty = np.full((1, *table.values.shape[1:]), np.nan)
    longer = replace(
        table,
        alternatives=(*table.alternatives, "unmeasured"),
        values=np.concatenate([table.values, empty]),
        failed=np.concatenate([table.failed, np.zeros(empty.shape, dtype=bool)]),
    )
    scores = score(longer, chosen)
    assert np.isnan(scores.scores[-1])
    np.testing.assert_allclose(scores.scores[:-1], score(table, chosen).scores, rtol=0, atol=1e-12)
