"""How far ranks move when some of the alternatives had never been there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aerocues.errors import ScoreError
from aerocues.scoring.correlation import rank_correlation
from aerocues.scoring.cues import Scores, rank, score

Array = NDArray[np.float64]
SHARE = 0.1
ROUNDS = 100


@dataclass(frozen=True)
class RankReversal:
    """Ranks of those that remain, against their order in the whole table.

    Attributes
    ----------
    share : float
        Of the alternatives, dropped in each round.
    rounds : int
        Those in which the alternatives that remain could be scored.
    mean_shift, largest_shift : float
        Places by which ranks moved: the mean over rounds and alternatives, and the most.
    spearman_mean, spearman_lowest : float
        Rank correlation with the order in the whole table; NaN where it is not defined.
    best_kept : float
        Share of the rounds in which the best of those that remain stayed the best.
    """

    share: float
    rounds: int
    mean_shift: float
    largest_shift: float
    spearman_mean: float
    spearman_lowest: float
    best_kept: float


def rank_reversal(
    scores: Scores, share: float = SHARE, rounds: int = ROUNDS, seed: int = 0
) -> RankReversal:
    """Drop a share of the alternatives at random, score the others anew, and see what moves.

    Of a handful of alternatives, one is dropped at least; a single one cannot be.

    Parameters
    ----------
    scores : Scores
    share : float
        Of the alternatives, between 0 and 1.
    rounds : int
        1 or more.
    seed : int

    Raises
    ------
    ScoreError
        If the share or the number of rounds is out of range.
    """
    if not 0 < share < 1 or rounds < 1:
        raise ScoreError(
            f"a share of {share} cannot be dropped {rounds} times; give a share between 0 and 1 "
            "and 1 round or more"
        )
    number = len(scores.table.alternatives)
    dropped = min(max(1, round(share * number)), number - 1)
    generator = np.random.default_rng(seed)
    shifts, correlations, kept = [], [], []
    for _ in range(rounds):
        left = np.sort(generator.permutation(number)[dropped:])
        before = scores.scores[left]
        try:
            after = score(scores.table.with_alternatives(left), scores.settings)
        except ScoreError:
            # None of those that are left has a value of some criterion: nothing to rank.
            continue
        shifts.append(np.abs(after.ranks - rank(before))[~np.isnan(before)])
        correlations.append(rank_correlation(np.stack([before, after.scores]))[0, 1])
        kept.append(bool(after.ranks[np.nanargmax(before)] == 1))
    known = np.array([value for value in correlations if not np.isnan(value)])
    moved = np.concatenate(shifts) if shifts else np.array([np.nan])
    return RankReversal(
        share=dropped / number,
        rounds=len(shifts),
        mean_shift=float(moved.mean()),
        largest_shift=float(moved.max()),
        spearman_mean=float(known.mean()) if len(known) else float("nan"),
        spearman_lowest=float(known.min()) if len(known) else float("nan"),
        best_kept=float(np.mean(kept)) if kept else float("nan"),
    )
