"""Ranks of what remains when some alternatives had never been there."""

from __future__ import annotations

import numpy as np
import pytest

from aerocues.errors import ScoreError
from aerocues.scoring import ScoreSettings, score
from aerocues.scoring.cues import rank
from aerocues.scoring.rank_reversal import rank_reversal
from tests.scoring.tables import random_table, table_of


def test_one_criterion_keeps_its_order() -> None:
    found = rank_reversal(score(random_table(0, alternatives=20, criteria=1)))
    assert (found.mean_shift, found.largest_shift, found.best_kept) == (0, 0, 1)
    assert found.spearman_lowest == pytest.approx(1)
    assert found.share == 0.1
    assert found.rounds == 100


def test_one_of_five_dropped_in_turn() -> None:
    # Of the 5 ways to drop one, one makes the best of the others lose its place.
    scores = score(random_table(17, alternatives=5, repeats=2))
    shifts, kept = [], []
    for dropped in range(5):
        left = [position for position in range(5) if position != dropped]
        before = rank(scores.scores[left])
        after = score(scores.table.with_alternatives(left)).ranks
        shifts.append(np.abs(after - before))
        kept.append(after[np.argmin(before)] == 1)
    assert sum(kept) == 4
    found = rank_reversal(scores, rounds=300)
    assert found.share == pytest.approx(1 / 5)
    assert found.largest_shift == np.max(shifts) == 3
    assert found.mean_shift == pytest.approx(np.mean(shifts), abs=0.1)
    assert found.best_kept == pytest.approx(0.8, abs=0.08)


def test_it_is_seeded() -> None:
    scores = score(random_table(1, alternatives=20))
    assert rank_reversal(scores, rounds=10, seed=4) == rank_reversal(scores, rounds=10, seed=4)
    assert rank_reversal(scores, rounds=10, seed=4) != rank_reversal(scores, rounds=10, seed=5)


def test_a_larger_share_moves_more() -> None:
    scores = score(random_table(2, alternatives=40, repeats=3))
    little, much = (rank_reversal(scores, share) for share in (0.05, 0.7))
    assert little.spearman_mean > much.spearman_mean
    assert little.spearman_lowest <= little.spearman_mean
    assert little.mean_shift <= little.largest_shift


def test_draws_that_cannot_be_scored_are_left_out() -> None:
    values = random_table(0, alternatives=3).values.copy()
    values[1:, :, 0] = np.nan
    found = rank_reversal(score(table_of(values)), rounds=60)
    # Without a0, the first criterion has no value; that is one draw in three.
    assert 25 <= found.rounds <= 55


def test_what_has_no_score_moves_no_rank() -> None:
    values = random_table(0, alternatives=10).values.copy()
    values[3] = np.nan
    found = rank_reversal(score(table_of(values), ScoreSettings(failures="omit")), rounds=20)
    assert np.isfinite(found.mean_shift)
    assert found.largest_shift <= 9


def test_of_one_alternative_none_can_be_dropped() -> None:
    found = rank_reversal(score(random_table(0, alternatives=1)), rounds=3)
    assert (found.share, found.largest_shift, found.best_kept) == (0, 0, 1)
    assert np.isnan(found.spearman_mean)


@pytest.mark.parametrize(("share", "rounds"), [(0, 10), (1, 10), (-0.1, 10), (0.1, 0)])
def test_arguments_out_of_range(share: float, rounds: int) -> None:
    with pytest.raises(ScoreError, match="0 and 1"):
        rank_reversal(score(random_table(0)), share, rounds)
