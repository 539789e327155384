"""Correlations against numpy and scipy."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import kendalltau, spearmanr

from aerocues.scoring import score
from aerocues.scoring.correlation import criteria_correlation, rank_correlation
from tests.scoring.tables import random_table, table_of

NAN = float("nan")


def test_criteria_as_numpy() -> None:
    scores = score(random_table(0))
    expected = np.corrcoef(random_table(0).values.mean(axis=1).T)
    np.testing.assert_allclose(criteria_correlation(scores), expected)


@pytest.mark.filterwarnings("error")
def test_a_constant_criterion_has_no_correlation() -> None:
    values = random_table(0, criteria=3).values.copy()
    values[:, :, 1] = 4
    found = criteria_correlation(score(table_of(values)))
    assert np.isnan(found).tolist() == [
        [False, True, False],
        [True, True, True],
        [False, True, False],
    ]


def test_criteria_over_the_alternatives_that_have_both() -> None:
    values = random_table(0).values.copy()
    values[2, :, 0] = NAN
    means = np.delete(values.mean(axis=1), 2, axis=0)
    found = criteria_correlation(score(table_of(values)))
    assert found[0, 1] == pytest.approx(np.corrcoef(means[:, 0], means[:, 1])[0, 1])


def test_rankings_as_scipy() -> None:
    rows = np.round(np.random.default_rng(0).uniform(size=(3, 20)), 1)
    spearman, kendall = rank_correlation(rows), rank_correlation(rows, "kendall")
    for first in range(3):
        for second in range(3):
            pair = rows[first], rows[second]
            assert spearman[first, second] == pytest.approx(spearmanr(*pair).statistic)
            assert kendall[first, second] == pytest.approx(kendalltau(*pair).statistic)


def test_rankings_over_what_both_have() -> None:
    rows = np.array([[1, 2, 3, 4, NAN, 9], [1, 3, 2, 4, 5, NAN], [NAN, NAN, 1, 2, NAN, NAN]])
    found = rank_correlation(rows)
    # 1 2 3 4 against 1 3 2 4: 1 - 6 x 2 / (4 x 15).
    assert found[0, 1] == pytest.approx(0.8)
    # Of the last, fewer than 3 are in common.
    assert np.isnan(found[2]).all()


@pytest.mark.filterwarnings("error")
def test_a_ranking_of_equals_has_no_correlation() -> None:
    rows = np.array([[1.0, 1.0, 1.0 + 1e-15, 1.0], [1, 2, 3, 4]])
    np.testing.assert_array_equal(rank_correlation(rows), [[NAN, NAN], [NAN, 1]])
