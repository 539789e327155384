"""Tests of the best against the others, and the correction for their number."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.stats import ttest_rel, wilcoxon

from aerocues.errors import ArgumentError
from aerocues.scoring import DecisionTable, Scores, ScoreSettings, score
from aerocues.scoring.bootstrap import bootstrap
from aerocues.scoring.per_repeat import scores_of_repeats, scores_of_units
from aerocues.scoring.significance import Comparisons, compare_with_one, holm
from tests.scoring.tables import random_table, table_of

NAN = float("nan")
LINEAR = ScoreSettings(alpha=1)


def compare(
    table: DecisionTable,
    settings: ScoreSettings = LINEAR,
    resamples: int = 200,
    test: str = "bootstrap",
) -> Comparisons:
    scores = score(table, settings)
    return compare_with_one(scores, bootstrap(scores, resamples), test)


def test_holm_by_hand() -> None:
    # Sorted: 0.005 x 4, 0.01 x 3, 0.03 x 2, 0.04 x 1, never less than the one before.
    corrected = holm(np.array([0.01, 0.04, 0.03, 0.005]))
    assert corrected == pytest.approx([0.03, 0.06, 0.06, 0.02])


def test_holm_never_exceeds_1() -> None:
    assert holm(np.array([0.6, 0.5, 0.9])) == pytest.approx([1, 1, 1])


def test_holm_leaves_out_what_is_no_comparison() -> None:
    corrected = holm(np.array([NAN, 0.01, NAN, 0.03]))
    assert corrected == pytest.approx([NAN, 0.02, NAN, 0.03], nan_ok=True)
    assert np.isnan(holm(np.array([NAN, NAN]))).all()
    assert len(holm(np.array([]))) == 0


def held_bounds(seed: int, alternatives: int, repeats: int, spread: float = 0.1) -> DecisionTable:
    """One criterion in which every repeat holds a 0 and a 1, so that all resamples have them.

    The two last alternatives hold them in turn; the mean of the others falls from 0.75 to 0.65.
    """
    mean = np.linspace(0.75, 0.65, alternatives)[:, None]
    draw = np.random.default_rng(seed).normal(mean, spread, size=(alternatives, repeats))
    ends = np.arange(repeats) % 2
    values = np.concatenate([draw.clip(0.01, 0.99), ends[None], 1 - ends[None]])
    return table_of(values[:, :, None])


def expected_by(test: object, scores: Scores, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Holm-corrected p-values by one of scipy's paired tests on single repeats."""
    p_values = np.full(len(values), NAN)
    for position, row in enumerate(values):
        if position != scores.best:
            p_values[position] = test(values[scores.best], row).pvalue  # type: ignore[operator]
    return holm(p_values)


@pytest.mark.parametrize("seed", range(4))
def test_on_a_linear_score_it_is_the_paired_t_test(seed: int) -> None:
    table = held_bounds(seed, alternatives=5, repeats=24)
    scores = score(table, LINEAR)
    found = compare_with_one(scores, bootstrap(scores, 4000), "bootstrap")
    expected = expected_by(ttest_rel, scores, table.values[:, :, 0])
    assert found.one == scores.best
    assert found.test == "bootstrap"
    np.testing.assert_allclose(found.p_value, expected, rtol=0.3, atol=0.003)


@pytest.mark.parametrize("seed", range(3))
def test_wilcoxon_agrees_with_scipy(seed: int) -> None:
    table = random_table(seed, repeats=15)
    scores = score(table)
    found = compare_with_one(scores, bootstrap(scores, 10), "wilcoxon")
    expected = expected_by(wilcoxon, scores, scores_of_repeats(scores))
    np.testing.assert_allclose(found.p_value, expected)


def test_wilcoxon_is_on_blocks() -> None:
    table = table_of(random_table(0, repeats=12).values, blocks=[0, 1, 2, 3, 4, 5] * 2)
    scores = score(table)
    found = compare_with_one(scores, bootstrap(scores, 10), "wilcoxon")
    expected = expected_by(wilcoxon, scores, scores_of_units(scores))
    np.testing.assert_allclose(found.p_value, expected)


def test_differences_are_those_of_the_scores() -> None:
    scores = score(random_table(0))
    found = compare_with_one(scores, bootstrap(scores, 20))
    np.testing.assert_allclose(found.difference, scores.scores.max() - scores.scores)
    assert found.difference[found.one] == 0
    assert np.isnan(found.p_value[found.one])
    assert found.one not in found.indistinguishable()
    np.testing.assert_array_equal(found.indistinguishable(), np.flatnonzero(found.p_value >= 0.05))


@pytest.mark.parametrize("test", ["bootstrap", "wilcoxon"])
def test_identical_alternatives_cannot_be_told_apart(test: str) -> None:
    values = random_table(0, alternatives=40, repeats=10).values.copy()
    best = score(table_of(values)).best
    values[[3, 17, 38]] = values[best]
    found = compare(table_of(values), ScoreSettings(), test=test)
    same = {3, 17, 38, best} - {found.one}
    assert set(found.p_value[sorted(same)]) == {1.0}


def test_what_is_better_in_every_repeat_is_found() -> None:
    found = compare(held_bounds(0, alternatives=5, repeats=40, spread=0.01))
    assert found.one == 0
    assert found.indistinguishable().tolist() == []


def test_few_repeats_in_common_tell_little() -> None:
    # Thrice the same alternative but for how often it was measured: in 20 repeats, in 6 or in 4.
    values = held_bounds(0, alternatives=2, repeats=20, spread=0.02).values.copy()
    values = np.insert(values, [2, 2], values[1], axis=0)
    values[2, 6:] = NAN
    values[3, 4:] = NAN
    found = compare(table_of(values, failed=np.zeros(values.shape, dtype=bool)))
    assert found.one == 0
    assert found.p_value[1] < 1e-6
    assert found.p_value[1] < found.p_value[2]
    assert np.isnan(found.p_value[3])
    assert found.untested().tolist() == [3]
    assert 3 not in found.indistinguishable()


def test_a_best_that_loses_repeat_by_repeat_is_not_told_from_the_other() -> None:
    # The first wins by four outliers, the second by a little in all other repeats.
    generator = np.random.default_rng(0)
    second = generator.uniform(0.4, 0.5, size=30)
    first = second - 0.01
    first[:4] = 1.0
    scores = score(table_of(np.stack([first, second])[:, :, None]), ScoreSettings(alpha=1))
    found = compare_with_one(scores, bootstrap(scores, 200), "wilcoxon")
    assert found.one == 0
    assert found.indistinguishable().tolist() == [1]


def test_false_alarms_of_two_alike() -> None:
    # Of two alternatives alone, the weights would follow the difference; four worse ones hold them.
    alarms = 0
    for seed in range(150):
        values = np.random.default_rng(seed).normal(size=(6, 15, 3))
        values[2:] -= np.linspace(2, 4, 4)[:, None, None]
        scores = score(table_of(values))
        found = compare_with_one(scores, bootstrap(scores, 200))
        assert found.one in (0, 1)
        alarms += int(found.p_value[1 - found.one] < 0.05)
    # 5 % of 150 are 7.5, with a standard deviation of 2.7.
    assert alarms <= 14


def test_the_truly_best_is_seldom_lost() -> None:
    # Ten alike: the first is as good as any, and told from the luckiest one as seldom as stated.
    lost = 0
    for seed in range(150):
        values = np.random.default_rng(seed).normal(size=(10, 15, 3))
        lost += int(compare(table_of(values), ScoreSettings()).p_value[0] < 0.05)
    assert lost <= 13


def test_of_one_unit_nothing_can_be_told() -> None:
    found = compare(table_of(random_table(0, repeats=1).values))
    assert np.isnan(found.p_value).all()
    assert len(found.untested()) == len(found.p_value) - 1


def test_an_unknown_test() -> None:
    scores = score(random_table(0))
    with pytest.raises(ArgumentError, match="bootstrap, wilcoxon"):
        compare_with_one(scores, bootstrap(scores, 5), "sign")


def test_others_are_compared_with_a_chosen_one() -> None:
    """Of three that differ by ever the same, the middle one is worse than one, better than one."""
    noise = np.random.default_rng(0).normal(0, 0.01, (3, 30, 1))
    table = table_of(np.array([0.2, 0.5, 0.8])[:, None, None] + noise)
    scores = score(table, LINEAR)
    resampled = bootstrap(scores, 100)
    middle = table.alternatives[1]
    found = compare_with_one(scores, resampled, against=middle)
    assert (found.one, found.surpassed().tolist(), found.surpassing().tolist()) == (1, [0], [2])
    assert compare_with_one(scores, resampled, against=middle.upper()).one == found.one
    assert compare_with_one(scores, resampled).surpassing().tolist() == []
    with pytest.raises(ArgumentError, match="against"):
        compare_with_one(scores, resampled, against="nobody")
