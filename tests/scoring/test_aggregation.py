"""How the weights of several methods become one set."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import gmean, hmean

from aerocues.scoring.aggregation import AGGREGATIONS, aggregate

FOUR = np.array([[0.1, 0.6, 0.3], [0.2, 0.2, 0.6], [0.4, 0.4, 0.2], [0.7, 0.1, 0.2]])


def test_arithmetic_by_hand() -> None:
    assert aggregate(FOUR, "arithmetic") == pytest.approx([0.35, 0.325, 0.325])


def test_trimmed_is_the_mean_of_the_two_middle_ones_of_four() -> None:
    # Middle ones: 0.2 0.4, 0.2 0.4 and 0.2 0.3, so 0.3 0.3 0.25 before they sum to 1.
    assert aggregate(FOUR, "trimmed") == pytest.approx(np.array([0.3, 0.3, 0.25]) / 0.85)


def test_trimmed_of_two_is_their_mean() -> None:
    assert aggregate(FOUR[:2], "trimmed") == pytest.approx([0.15, 0.4, 0.45])


def test_geometric_by_hand() -> None:
    # sqrt(0.2 x 0.8) = 0.4 and sqrt(0.8 x 0.2) = 0.4.
    assert aggregate(np.array([[0.2, 0.8], [0.8, 0.2]]), "geometric") == pytest.approx([0.5, 0.5])
    expected = gmean(FOUR, axis=0)
    assert aggregate(FOUR, "geometric") == pytest.approx(expected / expected.sum())


def test_harmonic_by_hand() -> None:
    # 2 / (1/0.2 + 1/0.6) = 0.3 and 2 / (1/0.8 + 1/0.4) = 8/15.
    weights = np.array([[0.2, 0.8], [0.6, 0.4]])
    expected = np.array([0.3, 8 / 15])
    assert aggregate(weights, "harmonic") == pytest.approx(expected / expected.sum())
    expected = hmean(FOUR, axis=0)
    assert aggregate(FOUR, "harmonic") == pytest.approx(expected / expected.sum())


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("name", ["geometric", "harmonic"])
def test_a_weight_of_zero_by_one_method_is_zero(name: str) -> None:
    weights = np.array([[0, 0.5, 0.5], [0.2, 0.4, 0.4]])
    assert aggregate(weights, name) == pytest.approx([0, 0.5, 0.5])


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("name", ["geometric", "harmonic"])
def test_methods_that_share_no_criterion_are_averaged(name: str) -> None:
    assert aggregate(np.array([[1.0, 0.0], [0.0, 1.0]]), name) == pytest.approx([0.5, 0.5])


@pytest.mark.parametrize("name", AGGREGATIONS)
def test_one_method_alone_stays_as_it_is(name: str) -> None:
    assert aggregate(FOUR[:1], name) == pytest.approx(FOUR[0])


@pytest.mark.parametrize("name", AGGREGATIONS)
def test_a_batch_equals_one_at_a_time(name: str) -> None:
    batch = np.random.default_rng(0).dirichlet(np.ones(5), size=(6, 4))
    together = aggregate(batch, name)
    assert together.shape == (6, 5)
    np.testing.assert_allclose(together.sum(axis=1), 1)
    for position, weights in enumerate(batch):
        np.testing.assert_allclose(together[position], aggregate(weights, name))
