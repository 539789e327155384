"""Scores of single repeats, of blocks of them, and the thesis's interval."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from aerocues.scoring import ScoreSettings, score
from aerocues.scoring.per_repeat import interval_of_repeats, scores_of_repeats, scores_of_units
from tests.scoring.tables import random_table, table_of

NAN = float("nan")

# As in test_cues: weights 12/19 and 7/19, both criteria between 0 and 16, the second a cost.
VALUES = [
    [[16, 16], [16, 16]],
    [[4, 0], [4, 14]],
    [[0, 8], [0, 16]],
]


def test_scores_of_repeats_by_hand() -> None:
    scores = score(table_of(VALUES, costs=[1]), ScoreSettings(weights=("variance",)))
    expected = [
        [12, 12],
        [6 + 7, 6 + 7 * math.sqrt(1 / 8)],
        [7 * math.sqrt(1 / 2), 0],
    ]
    np.testing.assert_allclose(scores_of_repeats(scores), np.array(expected) / 19, atol=1e-12)


def test_a_failed_repeat_is_0_or_missing() -> None:
    values = random_table(0).values.copy()
    values[2, 3] = NAN
    table = table_of(values)
    worst = scores_of_repeats(score(table))
    omitted = scores_of_repeats(score(table, ScoreSettings(failures="omit")))
    assert worst[2, 3] == 0
    assert np.isnan(omitted).sum() == 1
    assert np.isnan(omitted[2, 3])


def test_with_alpha_1_the_mean_of_the_repeats_is_the_score() -> None:
    scores = score(random_table(0), ScoreSettings(alpha=1))
    np.testing.assert_allclose(scores_of_repeats(scores).mean(axis=1), scores.scores)


def test_units_are_means_of_blocks() -> None:
    blocks = [0, 1, 2, 3, 4, 0, 1]
    table = table_of(random_table(0, repeats=7).values, blocks=blocks)
    single, units = scores_of_repeats(score(table)), scores_of_units(score(table))
    assert units.shape == (8, 5)
    np.testing.assert_allclose(units[:, 0], (single[:, 0] + single[:, 5]) / 2)
    np.testing.assert_allclose(units[:, 4], single[:, 4])


def test_units_average_what_was_measured() -> None:
    values = random_table(0, repeats=7).values.copy()
    values[3, 0] = values[4, 2] = NAN
    table = table_of(
        values, failed=np.zeros(values.shape, dtype=bool), blocks=[0, 1, 2, 3, 4, 0, 1]
    )
    single, units = scores_of_repeats(score(table)), scores_of_units(score(table))
    assert units[3, 0] == pytest.approx(single[3, 5])
    assert np.isnan(units[4, 2])
    assert np.isnan(units).sum() == 1


def test_many_repeats_are_scored_as_few() -> None:
    table = random_table(0, repeats=150)
    whole = scores_of_repeats(score(table))
    position = 149
    values, scores = table.values[:, [position]], score(table)
    means = (values[:, 0] - table.values.min(axis=(0, 1))) / np.ptp(table.values, axis=(0, 1))
    x = np.where(table.is_cost, 1 - means, means) ** 0.5
    np.testing.assert_allclose(whole[:, position], x @ scores.weights)


def test_interval_is_that_of_the_mean_of_the_repeats() -> None:
    scores = score(random_table(0, repeats=40))
    values = scores_of_repeats(scores)
    low, high = interval_of_repeats(scores, 2000)
    mean, error = values.mean(axis=1), values.std(axis=1) / np.sqrt(40)
    np.testing.assert_allclose(low, mean - 1.96 * error, atol=0.2 * error.max())
    np.testing.assert_allclose(high, mean + 1.96 * error, atol=0.2 * error.max())


def test_interval_is_repeatable_and_of_each_alternative_alone() -> None:
    scores = score(random_table(0))
    one, same = interval_of_repeats(scores, 50, seed=3), interval_of_repeats(scores, 50, seed=3)
    np.testing.assert_array_equal(one, same)
    order = np.array([4, 2, 7, 0, 1, 3, 5, 6])
    shuffled = score(scores.table.with_alternatives(order))
    np.testing.assert_allclose(
        np.array(interval_of_repeats(shuffled, 50, seed=3)), np.array(one)[:, order]
    )


def test_interval_of_what_has_no_scored_repeat() -> None:
    values = random_table(0).values.copy()
    values[1] = NAN
    scores = score(table_of(values), ScoreSettings(failures="omit"))
    low, high = interval_of_repeats(replace(scores), 20)
    assert np.isnan([low[1], high[1]]).all()
    assert not np.isnan(np.delete(low, 1)).any()
