"""Weights against arithmetic by hand, published examples and independent libraries."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import ArrayLike, NDArray
from pymcdm import weights as pymcdm_weights

from aerocues.scoring.weights import WEIGHT_METHODS, weights_by_method

Array = NDArray[np.float64]
ALL = tuple(WEIGHT_METHODS)


def weigh(matrix: ArrayLike, method: str) -> Array:
    """The weights of one matrix (alternatives, criteria) by one method."""
    weights = weights_by_method(np.asarray(matrix, dtype=np.float64)[None], (method,))
    return np.asarray(weights[0, 0])


def min_maxed(seed: int, alternatives: int = 12, criteria: int = 5) -> Array:
    """Criteria that depend on each other, in [0, 1]; each has a 0 and a 1."""
    generator = np.random.default_rng(seed)
    values = generator.normal(size=(alternatives, criteria)) + generator.normal(
        size=(alternatives, 1)
    )
    return np.asarray((values - values.min(axis=0)) / np.ptp(values, axis=0))


def test_entropy_in_bits_by_hand() -> None:
    # Shares of 4 alternatives (at most 2 bits): 1/2 1/4 1/4 0 have 1.5 bits, 1/2 1/2 0 0 have 1
    # bit, 1 0 0 0 has none: 1 - entropy is 1/4, 1/2 and 1.
    matrix = np.array([[1, 1, 1], [0.5, 1, 0], [0.5, 0, 0], [0, 0, 0]])
    assert weigh(matrix, "entropy") == pytest.approx([1 / 7, 2 / 7, 4 / 7])


def test_entropy_of_the_published_fighter_aircraft() -> None:
    # Hwang and Yoon, "Multiple Attribute Decision Making" (1981): 4 aircraft, 6 attributes.
    # Entropy does not change with the unit of a criterion. The book's entropies have 4 digits, of
    # which 1 - entropy keeps 2.
    aircraft = np.array(
        [
            [2.0, 1500, 20000, 5.5, 5, 9],
            [2.5, 2700, 18000, 6.5, 3, 5],
            [1.8, 2000, 21000, 4.5, 7, 7],
            [2.2, 1800, 20000, 5.0, 5, 5],
        ]
    )
    published = [0.0649, 0.2055, 0.0133, 0.0829, 0.3570, 0.2764]
    weights = weigh(aircraft / aircraft.max(axis=0), "entropy")
    assert weights == pytest.approx(published, abs=2e-3)


# Covariance (17 6 / 6 8) / 100: eigenvalues 20 and 5 (/ 100), vectors (2 1) and (1 -2) / sqrt 5.
TWO_CRITERIA = [[1, 0.5], [0.8, 0.9], [0.2, 0.1], [0, 0.5]]


def test_variance_by_hand() -> None:
    assert weigh(TWO_CRITERIA, "variance") == pytest.approx([17 / 25, 8 / 25])


def test_pca_by_hand() -> None:
    # 20/25 x 2 + 5/25 x 1 against 20/25 x 1 + 5/25 x 2: 45 to 30.
    assert weigh(TWO_CRITERIA, "pca") == pytest.approx([0.6, 0.4])


# Equal deviations; r = 0.5 of the first two, -1 of the first and last, -0.5 of the last two.
THREE_CRITERIA = np.array([[0, 0, 1], [0.5, 1, 0.5], [1, 0.5, 0]])


def test_critic_by_hand() -> None:
    # Sums of 1 - r: 0.5 + 2, 0.5 + 1.5, 2 + 1.5.
    assert weigh(THREE_CRITERIA, "critic") == pytest.approx([2.5 / 8, 2 / 8, 3.5 / 8])


def test_critic_counts_the_deviation() -> None:
    assert weigh(THREE_CRITERIA * [1, 0.5, 1], "critic") == pytest.approx([2.5 / 7, 1 / 7, 3.5 / 7])


def test_published_critic_has_one_more_for_each_criterion() -> None:
    # 1 and sums of 1 - abs(r): 1 + 0.5 + 0, 1 + 0.5 + 0.5, 1 + 0 + 0.5.
    assert weigh(THREE_CRITERIA, "critic_published") == pytest.approx([0.3, 0.4, 0.3])


@pytest.mark.parametrize("seed", range(5))
def test_variance_and_entropy_agree_with_pymcdm(seed: int) -> None:
    matrix = min_maxed(seed)
    expected = pymcdm_weights.variance_weights(matrix)
    assert weigh(matrix, "variance") == pytest.approx(expected)
    # pymcdm gives a criterion with a 0 no entropy at all, so there must be none here.
    positive = 0.1 + 0.9 * matrix
    expected = pymcdm_weights.entropy_weights(positive)
    assert weigh(positive, "entropy") == pytest.approx(expected)


@pytest.mark.parametrize("seed", range(5))
def test_critic_agrees_with_pymcdm(seed: int) -> None:
    matrix = min_maxed(seed)
    matrix[:, 0] = 1 - matrix[:, 0]
    assert (np.corrcoef(matrix.T) < 0).any()
    expected = pymcdm_weights.critic_weights(matrix)
    assert weigh(matrix, "critic") == pytest.approx(expected)


@pytest.mark.parametrize("seed", range(5))
def test_pca_agrees_with_singular_values(seed: int) -> None:
    matrix = min_maxed(seed)
    _left, singular, components = np.linalg.svd(matrix - matrix.mean(axis=0), full_matrices=False)
    expected = (singular**2 / (singular**2).sum()) @ np.abs(components)
    assert weigh(matrix, "pca") == pytest.approx(expected / expected.sum())


def test_a_batch_equals_one_at_a_time() -> None:
    matrices = np.stack([min_maxed(seed) for seed in range(7)])
    matrices[3, :, 2] = 1  # one of the batch has a constant criterion
    matrices[5, 4] = np.nan  # and one an alternative less
    together = weights_by_method(matrices, ALL)
    for position, matrix in enumerate(matrices):
        alone = weights_by_method(matrix[None], ALL)[0]
        np.testing.assert_allclose(together[position], alone, atol=1e-13)


def test_alternatives_without_values_take_no_part() -> None:
    matrix = min_maxed(0)
    longer = np.insert(matrix, [0, 5, 12], np.nan, axis=0)
    whole = weights_by_method(matrix[None], ALL)
    np.testing.assert_allclose(weights_by_method(longer[None], ALL), whole, atol=1e-13)


@pytest.mark.parametrize("method", ALL)
@pytest.mark.parametrize("constant", [0.0, 0.3, 1.0])
def test_a_constant_criterion_weighs_nothing(method: str, constant: float) -> None:
    matrix = min_maxed(1, criteria=3)
    weights = weigh(np.insert(matrix, 1, constant, axis=1), method)
    assert weights[1] == 0
    assert weights.sum() == pytest.approx(1)
    if method != "critic_published":
        assert np.delete(weights, 1) == pytest.approx(weigh(matrix, method))


@pytest.mark.parametrize("method", ALL)
def test_where_nothing_varies_all_weigh_alike(method: str) -> None:
    assert weigh(np.full((4, 3), 0.7), method) == pytest.approx([1 / 3] * 3)
    assert weigh(np.array([[0.1, 0.5]]), method) == pytest.approx([0.5, 0.5])


def test_critic_of_one_criterion_twice_falls_back_to_alike() -> None:
    # Two that agree fully have no conflict; a constant one stays at 0.
    column = np.array([0, 0.2, 1])
    matrix = np.stack([column, column, np.ones(3)], axis=1)
    assert weigh(matrix, "critic") == pytest.approx([0.5, 0.5, 0])


SIGNS = np.array(
    [[(-1) ** bin(row & column).count("1") for column in range(8)] for row in range(8)]
)


@pytest.mark.parametrize("method", ALL)
@pytest.mark.parametrize("scale", [(1, 1, 1, 1), (1, 1, 0.5, 0.5), (1, 0.5, 1, 0.2)])
def test_order_of_criteria_has_no_influence_where_eigenvalues_are_equal(
    method: str, scale: tuple[float, ...]
) -> None:
    # Orthogonal criteria, two of them turned against each other: any turn is as good.
    criteria = SIGNS[:, 1:5] * np.array(scale)
    turn = np.array([[0.8, -0.6], [0.6, 0.8]])
    criteria[:, :2] = criteria[:, :2] @ turn
    matrix = (criteria + 2) / 4
    generator = np.random.default_rng(0)
    whole = weigh(matrix, method)
    for _ in range(10):
        order = generator.permutation(4)
        assert weigh(matrix[:, order], method) == pytest.approx(whole[order], abs=1e-9)


def test_pca_of_equal_eigenvalues_shares_alike() -> None:
    assert weigh((SIGNS[:, 1:4] + 1) / 2, "pca") == pytest.approx([1 / 3] * 3)


@pytest.mark.parametrize("seed", range(20))
def test_critic_of_two_alternatives_is_no_noise(seed: int) -> None:
    # Any two alternatives make all criteria agree or contradict each other fully.
    better = np.random.default_rng(seed).uniform(0.5, 1, size=4)
    matrix = np.stack([better, better / 2])
    assert weigh(matrix, "critic") == pytest.approx([0.25] * 4)
    matrix[:, 0] = matrix[::-1, 0]
    # The first contradicts three, each other one contradicts the first.
    conflict = np.array([3, 1, 1, 1]) * np.ptp(matrix, axis=0)
    assert weigh(matrix, "critic") == pytest.approx(conflict / conflict.sum())
