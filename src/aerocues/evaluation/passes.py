"""Which passes a run makes over the pairs: one for quality, one for times, or one for both.

Quality does not depend on who else is running, so all cores measure it at once, with exact search
in place of brute force, which finds the same matches. Times do: some pairs are measured again, one
stage call at a time on a core of its own.
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
    """One pass: how it is timed, and over which pairs; None stands for all."""

    timing: Timing
    pairs: frozenset[int] | None = None


def passes(pairs: Sequence[Pair], timing: Timing, timed_pairs: int, seed: int) -> tuple[Pass, ...]:
    """The passes of a run, in order.

    Parameters
    ----------
    pairs : sequence of Pair
        Of the dataset.
    timing : {"exclusive", "shared", "estimated"}
        The times that are asked for.
    timed_pairs : int
        How many pairs exclusive timing takes; 0 for all.
    seed : int
    """
    if timing != "exclusive":
        return (Pass(timing),)
    if timed_pairs == ALL_PAIRS or timed_pairs >= len(pairs):
        return (Pass("exclusive"),)
    # Without exact search the first pass waits for brute force.
    quality: Timing = "shared" if why_not_exact() else "estimated"
    return Pass(quality), Pass("exclusive", _sample(pairs, timed_pairs, seed))


def timed_alone(turns: Sequence[Pass], pairs: Sequence[Pair]) -> frozenset[int]:
    """Numbers of the pairs that some pass times by themselves."""
    return frozenset(
        pair.index
        for turn in turns
        if turn.timing == "exclusive"
        for pair in pairs
        if turn.pairs is None or pair.index in turn.pairs
    )


def _sample(pairs: Sequence[Pair], count: int, seed: int) -> frozenset[int]:
    """Numbers of pairs chosen at random: one of each sequence, then the second of each, and so on.

    A sample of more pairs holds the ones of fewer, so that what was timed stays of use.
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
