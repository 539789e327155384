"""Agreement with other methods of multi-criteria decision making."""

from __future__ import annotations

import sys

import numpy as np
import pytest
from scipy.stats import spearmanr

from aerocues.errors import MethodUnavailableError
from aerocues.scoring import Scores, ScoreSettings, score
from aerocues.scoring.agreement import agreement
from tests.scoring.tables import random_table, table_of

METHODS = ("CUES", "TOPSIS", "VIKOR", "PROMETHEE II", "COPRAS", "MOORA")


def normalised(scores: Scores) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    return np.asarray(scores.normalised ** (1 / scores.settings.alpha))


def test_all_methods_agree_where_one_alternative_is_better_than_the_next_in_everything() -> None:
    order = np.array([2, 0, 3, 1, 4])
    steps = np.linspace(0, 1, 5)[order]
    values = steps[:, None, None] + np.array([0, 0.01, 0.02])[None, :, None] * np.ones((1, 1, 3))
    values[:, :, 2] *= -1  # a cost
    found = agreement(score(table_of(values, costs=[2])))
    assert found.names == METHODS
    np.testing.assert_allclose(found.correlation, 1)
    assert set(found.best) == {"a4"}


def test_topsis_by_hand() -> None:
    # Distances from the ideal and from its opposite, of weighted values in [0, 1].
    scores = score(random_table(5, alternatives=12))
    matrix = normalised(scores)
    matrix = (matrix - matrix.min(axis=0)) / np.ptp(matrix, axis=0)
    far = np.sqrt(((matrix * scores.weights) ** 2).sum(axis=1))
    near = np.sqrt((((1 - matrix) * scores.weights) ** 2).sum(axis=1))
    expected = spearmanr(scores.scores, far / (far + near)).statistic
    found = agreement(scores)
    assert found.correlation[0, 1] == pytest.approx(expected)
    assert found.best[1] == scores.table.alternatives[int(np.argmax(far / (far + near)))]


def test_promethee_by_hand() -> None:
    # Net flow with the usual preference: weighted wins minus losses.
    scores = score(random_table(6, alternatives=12))
    matrix = normalised(scores)
    wins = np.sign(matrix[:, None] - matrix[None]) @ scores.weights
    expected = spearmanr(scores.scores, wins.sum(axis=1)).statistic
    assert agreement(scores).correlation[0, 3] == pytest.approx(expected)


def test_vikor_by_hand() -> None:
    scores = score(random_table(7, alternatives=12))
    matrix = normalised(scores)
    regret = scores.weights * (matrix.max(axis=0) - matrix) / np.ptp(matrix, axis=0)
    group, single = regret.sum(axis=1), regret.max(axis=1)
    q = (group - group.min()) / np.ptp(group) + (single - single.min()) / np.ptp(single)
    expected = spearmanr(scores.scores, -q).statistic
    assert agreement(scores).correlation[0, 2] == pytest.approx(expected)


def test_copras_by_hand() -> None:
    # Sum-normalised and weighted; S- is the sum over the costs, which stay costs here.
    scores = score(random_table(8, alternatives=12))
    cost = scores.table.is_cost
    values = np.where(cost, 1 - normalised(scores), normalised(scores))
    weighted = scores.weights * values / values.sum(axis=0)
    plus, minus = weighted[:, ~cost].sum(axis=1), weighted[:, cost].sum(axis=1)
    least = minus.min()
    q = plus + least * minus.sum() / (minus * (least / minus).sum())
    expected = spearmanr(scores.scores, q).statistic
    assert agreement(scores).correlation[0, 4] == pytest.approx(expected)


def test_an_alternative_without_any_cost_is_the_best_of_copras() -> None:
    values = np.array([[[0.5, 1.0]], [[0.4, 3.0]], [[0.6, 2.0]], [[0.2, 4.0]]])
    assert agreement(score(table_of(values, costs=[1]))).best[4] == "a0"


def test_higher_is_better_throughout() -> None:
    # The methods differ, but none turns the order round.
    for seed in range(5):
        found = agreement(score(random_table(seed, alternatives=30)))
        assert found.correlation.min() > 0.5


def test_methods_that_need_costs_are_not_defined_without() -> None:
    found = agreement(score(table_of(random_table(0).values)))
    assert found.best[4:] == ("", "")
    assert np.isnan(found.correlation[4:]).all()
    assert not np.isnan(found.correlation[:4, :4]).any()


def test_what_has_no_score_takes_no_part() -> None:
    values = random_table(0).values.copy()
    values[3] = np.nan
    settings = ScoreSettings(failures="omit")
    found = agreement(score(table_of(values, costs=[1]), settings))
    expected = agreement(score(table_of(np.delete(values, 3, axis=0), costs=[1]), settings))
    np.testing.assert_allclose(found.correlation, expected.correlation)


def test_without_pymcdm_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pymcdm", None)
    with pytest.raises(MethodUnavailableError, match=r"aerocues\[validation\]"):
        agreement(score(random_table(0)))
