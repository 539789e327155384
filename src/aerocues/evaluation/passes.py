"""The passes of a run over the pairs: one for quality, one for times, or one for both.

Quality does not depend on other processes, so it is measured on all cores at once, with exact
search in place of brute force (the matches are the same). Times do depend on them, so some pairs
are measured again, one stage call at a time on a core of its own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from aerocues.datasets.dataset import Pair
from aerocues.methods.exact.availability import why_not_exact
from aerocues.results.timing import Timing

ALL_PAIRS = 0


@dataclass(frozen=True)
class Pass:
    """One pass: its timing, and its pairs (None: all pairs)."""

    timing: Timing
    pairs: frozenset[int] | None = None


def passes(pairs: Sequence[Pair], timing: Timing, timed_pairs: int, seed: int) -> tuple[Pass, ...]:
    """The passes of a run, in order.

    Parameters
    ----------
    pairs : sequence of Pair
        Pairs of the dataset.
    timing : {"exclusive", "shared", "estimated"}
        The requested timing.
    timed_pairs : int
        Number of pairs with exclusive timing; 0 for all.
    seed : int
    """
    if timing != "exclusive":
        return (Pass(timing),)
    if timed_pairs == ALL_PAIRS or timed_pairs >= len(pairs):
        return (Pass("exclusive"),)
    # Without exact search the first pass uses brute force.
    quality: Timing = "shared" if why_not_exact() else "estimated"
    return Pass(quality), Pass("exclusive", _sample(pairs, timed_pairs, seed))


def timed_alone(turns: Sequence[Pass], pairs: Sequence[Pair]) -> frozenset[int]:
    """Numbers of the pairs with exclusive timing."""
    return frozenset(
        pair.index
        for turn in turns
        if turn.timing == "exclusive"
        for pair in pairs
        if turn.pairs is None or pair.index in turn.pairs
    )


def _sample(pairs: Sequence[Pair], count: int, seed: int) -> frozenset[int]:
    """Numbers of randomly chosen pairs: one of each sequence, then a second of each, and so on.

    A larger sample contains the smaller ones, so that earlier timings remain useful.
    """
    rng = np.random.default_rng(seed)
    by_sequence: dict[str, list[int]] = {}
    for position in rng.permutation(len(pairs)):
        pair = pairs[position]
        by_sequence.setdefault(pair.sequence, []).append(pair.index)
    rounds = max(len(members) for members in by_sequence.values())
    spread = [
        members[turn]
        for turn in range(rounds)
        for members in by_sequence.values()
        if turn < len(members)
    ]
    return frozenset(spread[:count])
