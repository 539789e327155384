"""Friedman's test and critical differences against published figures and scipy."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import friedmanchisquare

from aerocues.errors import ScoreError
from aerocues.scoring import score
from aerocues.scoring.friedman import critical_difference, friedman
from aerocues.scoring.per_repeat import scores_of_units
from tests.scoring.tables import random_table, table_of

# Demsar (JMLR 7, 2006), table 6: area under the curve of 4 classifiers on 14 data sets.
# On the last but one, the paper ranks the third above the fourth, which 3 digits do not show.
CLASSIFIERS = ("C4.5", "C4.5+m", "C4.5+cf", "C4.5+m+cf")
AUC = np.array(
    [
        [0.763, 0.768, 0.771, 0.798],
        [0.599, 0.591, 0.590, 0.569],
        [0.954, 0.971, 0.968, 0.967],
        [0.628, 0.661, 0.654, 0.657],
        [0.882, 0.888, 0.886, 0.898],
        [0.936, 0.931, 0.916, 0.931],
        [0.661, 0.668, 0.609, 0.685],
        [0.583, 0.583, 0.563, 0.625],
        [0.775, 0.838, 0.866, 0.875],
        [1.000, 1.000, 1.000, 1.000],
        [0.940, 0.962, 0.965, 0.962],
        [0.619, 0.666, 0.614, 0.669],
        [0.972, 0.981, 0.97501, 0.975],
        [0.957, 0.978, 0.946, 0.970],
    ]
).T


def test_published_mean_ranks_and_critical_difference() -> None:
    found = friedman(AUC, CLASSIFIERS)
    assert found.units == 14
    assert found.alternatives == ("C4.5+m+cf", "C4.5+m", "C4.5+cf", "C4.5")
    assert found.mean_ranks == pytest.approx([1.964, 2.000, 2.893, 3.143], abs=5e-4)
    assert found.critical_difference == pytest.approx(1.25, abs=0.005)


def test_published_statistics() -> None:
    # The paper leaves ties uncorrected: 3 pairs (2**3 - 2 each) and one of all four (4**3 - 4)
    # take 78 of 14 x (4**3 - 4) = 840 away.
    found = friedman(AUC, CLASSIFIERS)
    uncorrected = found.chi_square * (1 - 78 / 840)
    assert uncorrected == pytest.approx(9.28, abs=0.01)
    assert 13 * uncorrected / (14 * 3 - uncorrected) == pytest.approx(3.69, abs=0.01)
    assert found.f_statistic == pytest.approx(13 * found.chi_square / (14 * 3 - found.chi_square))
    assert found.f_p_value < 0.05


# Table 5 of the paper: q of the two-tailed Nemenyi test for 2 .. 10 classifiers.
@pytest.mark.parametrize(
    ("level", "published"),
    [
        (0.05, [1.960, 2.343, 2.569, 2.728, 2.850, 2.949, 3.031, 3.102, 3.164]),
        (0.10, [1.645, 2.052, 2.291, 2.459, 2.589, 2.693, 2.780, 2.855, 2.920]),
    ],
)
def test_published_critical_values(level: float, published: list[float]) -> None:
    for number, q in enumerate(published, start=2):
        found = friedman(np.zeros((number, 6)), [str(each) for each in range(number)], level)
        # sqrt(k (k + 1) / (6 N)) with N = 6.
        expected = q * np.sqrt(number * (number + 1)) / 6
        assert found.critical_difference == pytest.approx(expected, abs=0.002)


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("ties", [False, True])
def test_statistic_agrees_with_scipy(seed: int, ties: bool) -> None:
    values = np.random.default_rng(seed).uniform(size=(5, 9)) * 4
    values = np.round(values) if ties else values
    found = friedman(values, list("abcde"))
    expected = friedmanchisquare(*values)
    assert found.chi_square == pytest.approx(expected.statistic)
    assert found.p_value == pytest.approx(expected.pvalue)


def test_groups_are_the_largest_runs_within_the_critical_difference() -> None:
    # Ranks 1 .. 5 in each of 20 units: the critical difference is 1.364.
    found = friedman(np.repeat(np.arange(5.0, 0, -1)[:, None], 20, axis=1), list("abcde"))
    assert found.critical_difference == pytest.approx(1.364, abs=0.001)
    assert found.groups == ((0, 1), (1, 2), (2, 3), (3, 4))
    # In 9 units, it is 2.033; in 60, it is 0.788, and all can be told apart.
    few = friedman(np.repeat(np.arange(5.0, 0, -1)[:, None], 9, axis=1), list("abcde"))
    assert few.critical_difference == pytest.approx(2.033, abs=0.001)
    assert few.groups == ((0, 2), (1, 3), (2, 4))
    many = friedman(np.repeat(np.arange(5.0, 0, -1)[:, None], 60, axis=1), list("abcde"))
    assert many.groups == ()
    assert many.p_value < 1e-6


def test_groups_of_the_published_example() -> None:
    # 3.143 - 1.964 = 1.179 is less than 1.25: none can be told from another.
    assert friedman(AUC, CLASSIFIERS).groups == ((0, 3),)
    # At 0.10, it is 1.12 and the worst can be told from the two best.
    assert friedman(AUC, CLASSIFIERS, level=0.10).groups == ((0, 2), (2, 3))


@pytest.mark.filterwarnings("error")
def test_all_alike() -> None:
    found = friedman(np.ones((3, 4)), list("cab"))
    assert found.alternatives == ("a", "b", "c")
    assert (found.chi_square, found.p_value) == (0, 1)
    assert (found.f_statistic, found.f_p_value) == (0, 1)
    assert found.groups == ((0, 2),)


@pytest.mark.parametrize("shape", [(1, 5), (5, 1), (3, 0)])
def test_too_little_to_rank(shape: tuple[int, int]) -> None:
    with pytest.raises(ScoreError, match=r"\b2\b"):
        friedman(np.zeros(shape), [str(each) for each in range(shape[0])])


def test_a_shortlist_is_ranked_by_its_scores_of_units() -> None:
    scores = score(random_table(0))
    shortlist = scores.order[:4].tolist()
    found = critical_difference(scores, shortlist)
    names = [scores.table.alternatives[position] for position in shortlist]
    expected = friedman(scores_of_units(scores)[shortlist], names)
    assert found.alternatives == expected.alternatives
    assert found.mean_ranks == pytest.approx(expected.mean_ranks)
    assert found.units == 6


def test_only_units_that_all_were_measured_in_count() -> None:
    values = random_table(0).values.copy()
    values[2, :2] = np.nan
    table = table_of(values, failed=np.zeros(values.shape, dtype=bool))
    assert critical_difference(score(table), [0, 2]).units == 4
    assert critical_difference(score(table), [0, 1]).units == 6
