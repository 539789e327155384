"""Rankings under other choices."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import spearmanr

from aerocues.scoring import ScoreSettings, score
from aerocues.scoring.aggregation import AGGREGATIONS
from aerocues.scoring.sensitivity import by_aggregation, by_alpha, by_criterion_left_out
from tests.scoring.tables import random_table, table_of


def test_alpha_agrees_with_scores_one_by_one() -> None:
    scores = score(random_table(0))
    variants = by_alpha(scores, [0.1, 2])
    assert variants.names == ("0.1", "0.5", "2")
    rows = [score(scores.table, ScoreSettings(alpha=alpha)) for alpha in (0.1, 0.5, 2)]
    expected = spearmanr(np.stack([each.scores for each in rows]), axis=1).statistic
    np.testing.assert_allclose(variants.correlation, expected)
    assert variants.best == tuple(scores.table.alternatives[each.best] for each in rows)


def test_alpha_of_the_score_is_always_among_them() -> None:
    assert by_alpha(score(random_table(0), ScoreSettings(alpha=0.3))).names == (
        "0.1",
        "0.25",
        "0.3",
        "0.5",
        "0.75",
    )


def test_every_aggregation() -> None:
    scores = score(random_table(1))
    variants = by_aggregation(scores)
    assert variants.names == tuple(AGGREGATIONS)
    for position, name in enumerate(variants.names):
        other = score(scores.table, replace(scores.settings, aggregation=name))
        expected = spearmanr(scores.scores, other.scores).statistic
        assert variants.correlation[0, position] == pytest.approx(expected)


def test_each_criterion_left_out() -> None:
    scores = score(random_table(2, criteria=3))
    variants = by_criterion_left_out(scores)
    assert variants.names == ("all criteria", "without c0", "without c1", "without c2")
    without = score(table_of(scores.table.values[:, :, [0, 2]]))
    expected = spearmanr(scores.scores, without.scores).statistic
    assert variants.correlation[0, 2] == pytest.approx(expected)
    np.testing.assert_array_equal(variants.correlation, variants.correlation.T)
    np.testing.assert_array_equal(np.diag(variants.correlation), 1)


def test_a_criterion_alone_is_not_left_out() -> None:
    assert by_criterion_left_out(score(random_table(0, criteria=1))).names == ("all criteria",)


def test_correlations_of_two_alternatives_are_not_defined() -> None:
    assert np.isnan(by_alpha(score(random_table(0, alternatives=2))).correlation).all()
