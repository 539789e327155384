"""Rank reversal: how far ranks move when some alternatives are removed."""

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
    """Ranks of the remaining alternatives against their order in the whole table.

    Attributes
    ----------
    share : float
        Share of the alternatives that is removed in each round.
    rounds : int
        Rounds in which the remaining alternatives could be scored.
    mean_shift, largest_shift : float
        Change of rank: the mean over rounds and alternatives, and the largest.
    spearman_mean, spearman_lowest : float
        Rank correlation with the order in the whole table; NaN if undefined.
    best_kept : float
        Share of the rounds in which the best remaining alternative stayed the best.
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
    """Remove random alternatives, score the others anew, and measure how ranks move.

    At least one alternative is removed and at least one remains.

    Parameters
    ----------
    scores : Scores
    share : float
        Share of the alternatives to remove, between 0 and 1.
    rounds : int
        At least 1.
    seed : int

    Raises
    ------
    ScoreError
        If the share or the number of rounds is out of range.
    """
    if not 0 < share < 1 or rounds < 1:
        raise ScoreError(
            f"share must be between 0 and 1 and rounds at least 1, got {share} and {rounds}"
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
            # No remaining alternative has values in all criteria, so there is nothing to rank.
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
