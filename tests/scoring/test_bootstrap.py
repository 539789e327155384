"""Resamples: repeatable, joint, by blocks, and as wide as they should be."""

from __future__ import annotations

import math
import tracemalloc
from dataclasses import replace

import numpy as np
import pytest
import scipy.stats
from numpy.typing import NDArray

from aerocues.errors import ArgumentError
from aerocues.scoring import DecisionTable, ScoreSettings, score
from aerocues.scoring.bootstrap import bootstrap
from aerocues.scoring.resampling import draws, independent_units, unit_of_resampling
from tests.scoring.tables import random_table, table_of

NAN = float("nan")


def drawn(table: DecisionTable, resamples: int, seed: int = 0) -> NDArray[np.float64]:
    return next(draws(table, resamples, seed, resamples))


def test_the_seed_decides() -> None:
    scores = score(random_table(0))
    one, same, other = (bootstrap(scores, 30, seed) for seed in (1, 1, 2))
    np.testing.assert_array_equal(one.scores, same.scores)
    np.testing.assert_array_equal(one.ranks, same.ranks)
    assert not np.array_equal(one.scores, other.scores)


@pytest.mark.parametrize("failures", ["worst", "omit"])
def test_a_resample_is_the_score_of_the_repeats_drawn(failures: str) -> None:
    values = random_table(0).values.copy()
    values[1, 2] = values[4, :3, 1] = NAN
    table = table_of(values, costs=[1])
    settings = ScoreSettings(failures=failures)  # type: ignore[arg-type]
    resampled = bootstrap(score(table, settings), 20, seed=5)
    for position, counts in enumerate(drawn(table, 20, seed=5)):
        taken = np.repeat(np.arange(6), counts.astype(int))
        expected = score(table_of(values[:, taken], costs=[1]), settings)
        np.testing.assert_allclose(resampled.scores[position], expected.scores, atol=1e-12)
        np.testing.assert_allclose(resampled.weights[position], expected.weights, atol=1e-12)
        np.testing.assert_array_equal(resampled.ranks[position], expected.ranks)


def test_what_is_drawn_does_not_depend_on_the_batch() -> None:
    table = random_table(0, repeats=9)
    whole = drawn(table, 50)
    for batch in (1, 7, 50, 1000):
        np.testing.assert_array_equal(np.concatenate(list(draws(table, 50, 0, batch))), whole)


def test_scores_do_not_depend_on_the_batch(monkeypatch: pytest.MonkeyPatch) -> None:
    scores = score(random_table(0))
    whole = bootstrap(scores, 50)
    monkeypatch.setattr("aerocues.scoring.bootstrap.BATCH_ELEMENTS", 100)
    pieces = bootstrap(scores, 50)
    np.testing.assert_allclose(pieces.scores, whole.scores, rtol=0, atol=1e-12)
    np.testing.assert_array_equal(pieces.ranks, whole.ranks)


def test_all_alternatives_are_resampled_jointly() -> None:
    values = random_table(0).values.copy()
    values[5] = values[2]
    resampled = bootstrap(score(table_of(values)), 100)
    np.testing.assert_allclose(resampled.scores[:, 2], resampled.scores[:, 5], rtol=0, atol=1e-13)
    np.testing.assert_array_equal(resampled.ranks[:, 2], resampled.ranks[:, 5])
    assert np.ptp(resampled.scores[:, 2]) > 0


def test_an_alternative_always_a_little_better_is_always_ahead() -> None:
    values = random_table(0).values.copy()
    values[6] = values[3] + 1e-3
    resampled = bootstrap(score(table_of(values)), 100)
    assert (resampled.ranks[:, 6] < resampled.ranks[:, 3]).all()


def test_blocks_are_drawn_whole() -> None:
    blocks = [7, 7, 3, 3, 3, 9, 1, 1, 4, 4]
    table = table_of(random_table(0, repeats=10).values, blocks=blocks)
    assert unit_of_resampling(table) == "block"
    counts = drawn(table, 200)
    for block in set(blocks):
        members = np.flatnonzero(np.array(blocks) == block)
        assert (counts[:, members] == counts[:, members[:1]]).all()
    firsts = counts[:, [0, 2, 5, 6, 8]]
    assert (firsts.sum(axis=1) == 5).all()
    assert bootstrap(score(table), 10).unit == "block"


@pytest.mark.parametrize(
    "blocks", [[0] * 6, [0, 0, 1, 1, 2, 3], [0, 1, 2, 3, 4, 5]], ids=["one", "four", "single"]
)
def test_repeats_are_drawn_where_blocks_are_few_or_single(blocks: list[int]) -> None:
    table = table_of(random_table(0).values, blocks=blocks)
    assert unit_of_resampling(table) == "repeat"
    assert independent_units(table).tolist() == [0, 1, 2, 3, 4, 5]
    counts = drawn(table, 2000)
    assert (counts.sum(axis=1) == 6).all()
    np.testing.assert_allclose(counts.mean(axis=0), 1, atol=0.1)


def anchored(seed: int, alternatives: int, repeats: int) -> DecisionTable:
    """One criterion of values in (0, 1); the last two hold 0 and 1, so that bounds stay.

    Their scores, with alpha = 1, are means of normal draws around 0.5.
    """
    draw = np.random.default_rng(seed).normal(0.5, 0.1, size=(alternatives, repeats, 1))
    ends = np.repeat([[[0.0]], [[1.0]]], repeats, axis=1)
    return table_of(np.concatenate([draw.clip(0.01, 0.99), ends]))


@pytest.mark.parametrize("repeats", [6, 40])
def test_intervals_hold_the_truth_as_often_as_they_should(repeats: int) -> None:
    scores = score(anchored(0, 1500, repeats), ScoreSettings(alpha=1))
    low, high = bootstrap(scores, 400).score_interval()
    covered = ((low <= 0.5) & (high >= 0.5))[:-2].mean()
    assert 0.93 <= covered <= 0.97


def test_the_interval_of_a_mean_is_that_of_student() -> None:
    table = anchored(1, 20, 6)
    low, high = bootstrap(score(table, ScoreSettings(alpha=1)), 4000).score_interval()
    values = table.values[:-2, :, 0]
    error = scipy.stats.sem(values, axis=1)
    # One degree of freedom less than that of a mean of six: the scale is estimated, too.
    expected = scipy.stats.t.interval(0.95, 4, values.mean(axis=1), error)
    np.testing.assert_allclose(low[:-2], np.maximum(expected[0], 0), atol=0.01)
    np.testing.assert_allclose(high[:-2], np.minimum(expected[1], 1), atol=0.01)


def test_the_standard_error_is_that_of_a_mean() -> None:
    table = anchored(1, 20, 30)
    resampled = bootstrap(score(table, ScoreSettings(alpha=1)), 2000)
    expected = table.values[:-2, :, 0].std(axis=1) / np.sqrt(30)
    np.testing.assert_allclose(resampled.scores[:, :-2].std(axis=0), expected, rtol=0.1)


def test_intervals_and_probabilities_fit_the_ranking() -> None:
    scores = score(random_table(3, alternatives=12, repeats=20))
    resampled = bootstrap(scores, 300)
    low, high = resampled.rank_interval()
    assert (low <= scores.ranks).all()
    assert (scores.ranks <= high).all()
    assert (low >= 1).all()
    assert (high <= 12).all()
    assert resampled.probability_in_top(1).sum() == pytest.approx(1)
    assert resampled.probability_in_top(5).sum() == pytest.approx(5)
    assert resampled.probability_in_top(12) == pytest.approx(np.ones(12))
    np.testing.assert_allclose(resampled.weights.sum(axis=1), 1)


def test_a_narrower_interval_lies_within_the_wider() -> None:
    resampled = bootstrap(score(random_table(3)), 200)
    (low, high), (lower, higher) = (resampled.score_interval(c) for c in (0.5, 0.95))
    assert (lower <= low).all()
    assert (high <= higher).all()


def test_what_has_no_score_takes_no_part() -> None:
    values = random_table(0).values.copy()
    values[2] = NAN
    resampled = bootstrap(score(table_of(values), ScoreSettings(failures="omit")), 50)
    assert np.isnan(resampled.scores[:, 2]).all()
    assert np.isnan(np.array(resampled.rank_interval())[:, 2]).all()
    assert resampled.probability_in_top(8)[2] == 0
    assert resampled.ranks[:, 3].max() <= 7


def test_an_alternative_seldom_valid_is_judged_by_the_resamples_that_hold_it() -> None:
    values = random_table(0).values.copy()
    values[2, 2:] = NAN
    resampled = bootstrap(score(table_of(values), ScoreSettings(failures="omit")), 300)
    missing = np.isnan(resampled.scores[:, 2])
    # None of 6 repeats drawn is one of the first two: (4 / 6) ** 6 = 0.09.
    assert missing.mean() == pytest.approx(0.09, abs=0.05)
    # Student's t of two repeats has one degree of freedom.
    assert resampled.units_of.tolist() == [6, 6, 2, *[6] * (len(values) - 3)]
    reach = 12.706 * math.sqrt(2) * np.nanstd(resampled.scores[:, 2])
    low, high = resampled.score_interval()
    assert low[2] == pytest.approx(max(resampled.centre[2] - reach, 0), abs=1e-3)
    assert high[2] == pytest.approx(min(resampled.centre[2] + reach, 1), abs=1e-3)


def test_an_alternative_valid_once_has_no_interval() -> None:
    values = random_table(0).values.copy()
    values[2, 1:] = NAN
    resampled = bootstrap(score(table_of(values), ScoreSettings(failures="omit")), 300)
    for low, high in (resampled.score_interval(), resampled.rank_interval()):
        assert np.isnan([low[2], high[2]]).all()
        assert not np.isnan(np.delete(low, 2)).any()


@pytest.mark.parametrize(("resamples", "seed"), [(1, 0), (0, 0), (10, -1)])
def test_arguments_out_of_range(resamples: int, seed: int) -> None:
    with pytest.raises(ArgumentError):
        bootstrap(score(random_table(0)), resamples, seed)


@pytest.mark.slow
def test_memory_stays_bounded_for_many_repeats() -> None:
    table = random_table(0, alternatives=466, repeats=1000, criteria=8)
    scores = score(replace(table, blocks=np.arange(1000)))
    tracemalloc.start()
    bootstrap(scores, 1000)
    _now, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 400e6
