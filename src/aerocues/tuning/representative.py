"""Which pairs stand for all of a data set: spread over it, and seen to show the same things."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from aerocues.datasets.dataset import Pair
from aerocues.errors import DatasetError
from aerocues.evaluation.engine import Engine
from aerocues.methods.combination import Combination
from aerocues.tuning.layout import blocks_of, spread_order
from aerocues.tuning.pair_evaluator import PairEvaluator
from aerocues.tuning.session import Session

MOST_PAIRS = 24
# Fewer pairs tell next to nothing of the others.
FEWEST_PAIRS = 2
# Strong ones of different kinds, quick to run; a pair on which all fail is taken to share nothing.
PROBES = ("SIFT-SIFT-L2-FLANN", "GFTT_H-BRIEF-HAM-BF", "AKAZE-AKAZE-HAM-BF")
# Looked at together: where time is short, the first ones have to do.
FIRST, SECOND = 2, 8
# Shares of the budget: of looking at pairs, and of looking for any at all.
LOOKING, SEARCHING = 0.25, 0.6


@dataclass(frozen=True)
class Seen:
    """Numbers of the pairs whose images show the same things, and of those where none was seen.

    `unseen` are those that there was no time to look at.
    """

    overlapping: tuple[int, ...]
    others: tuple[int, ...]
    unseen: tuple[int, ...] = ()


def spread_pairs(pairs: Sequence[Pair], most: int = MOST_PAIRS, seed: int = 0) -> list[Pair]:
    """At most so many pairs, evenly spread over each sequence, each sequence by its share.

    Every sequence keeps one pair at least; where there are more sequences than that, a random one
    of each run of neighbours stands for them.
    """
    if len(pairs) <= most:
        return list(pairs)
    sequences: dict[str, list[Pair]] = {}
    for pair in pairs:
        sequences.setdefault(pair.sequence, []).append(pair)
    kept = list(sequences.values())
    if len(kept) > most:
        rng = np.random.default_rng(seed)
        runs = np.array_split(np.arange(len(kept)), most)
        kept = [kept[int(rng.choice(run))] for run in runs]
    shares = _shares([len(own) for own in kept], most)
    return [pair for own, share in zip(kept, shares, strict=True) for pair in _evenly(own, share)]


def _shares(sizes: Sequence[int], most: int) -> list[int]:
    """Parts of `most` in proportion to the sizes, each 1 or more and no larger than its size."""
    shares = [1] * len(sizes)
    for _ in range(min(most, sum(sizes)) - len(sizes)):
        lacking = [
            size / (share + 0.5) if share < size else 0.0
            for size, share in zip(sizes, shares, strict=True)
        ]
        shares[int(np.argmax(lacking))] += 1
    return shares


def _evenly(own: Sequence[Pair], count: int) -> list[Pair]:
    return [own[int((place + 0.5) * len(own) / count)] for place in range(count)]


def probes() -> list[Combination]:
    """The combinations that tell whether two images show the same things."""
    return [Combination.parse(name) for name in PROBES]


def look_for_overlap(
    evaluator: PairEvaluator, engine: Engine, pairs: Sequence[Pair], session: Session, seed: int = 0
) -> Seen:
    """Tell which pairs show the same things: some probe finds a model that is no chance.

    Where a quarter of the budget does not suffice for all, some pairs that are spread over all of
    them are looked at; where it does not for two that overlap, it may take longer.

    Parameters
    ----------
    evaluator : PairEvaluator
        Whose protocol tests against chance.
    engine : Engine
    pairs : sequence of Pair
    session : Session
    seed : int

    Raises
    ------
    DatasetError
        If no pair does: its message says whether images are blank or do not overlap.
    SelectionError
        If time is up before one is found.
    """
    order = spread_order(blocks_of(pairs), np.random.default_rng(seed))
    spread = [pairs[place].index for place in order]
    look = _Look(evaluator, engine, session)
    for start, end in ((0, FIRST), (FIRST, SECOND), (SECOND, len(spread))):
        look.at(spread[start:end])
    seen = Seen(
        *(
            tuple(pair.index for pair in pairs if pair.index in found)
            for found in (look.overlapping, look.others, look.unseen)
        )
    )
    if seen.overlapping:
        return seen
    if seen.unseen:
        raise session.too_small(
            f"no two images that show the same things were found in time, and "
            f"{len(seen.others)} of {len(pairs)} pairs were looked at"
        )
    raise DatasetError(_why_none(evaluator, seen.others))


@dataclass
class _Look:
    evaluator: PairEvaluator
    engine: Engine
    session: Session
    overlapping: set[int] = field(default_factory=set)
    others: set[int] = field(default_factory=set)
    unseen: set[int] = field(default_factory=set)

    def at(self, pairs: Sequence[int]) -> None:
        """Look at pairs, one probe after the other on those where none has found anything yet."""
        left = list(pairs)
        for probe in probes():
            left = self._without_model(left, probe)
        self.others |= set(left) - self.unseen

    def _without_model(self, pairs: Sequence[int], probe: Combination) -> list[int]:
        asked = [(pair, probe) for pair in pairs if self.evaluator.possible((pair, probe))]
        if not asked:
            return list(pairs)
        until = self._share() * self.session.budget
        missing = self.session.measure(self.evaluator, self.engine, asked, until=until)
        late = {pair for pair, _ in asked if self.evaluator.row_key((pair, probe)) in missing}
        found = {pair for pair, _ in asked if pair not in late and self._is_ok(pair, probe)}
        self.unseen |= late
        self.overlapping |= found
        self.unseen -= found
        return [pair for pair in pairs if pair not in found]

    def _is_ok(self, pair: int, probe: Combination) -> bool:
        row = self.evaluator.row((pair, probe))
        return row is not None and row["status"] == "ok"

    def _share(self) -> float:
        return LOOKING if len(self.overlapping) >= FEWEST_PAIRS else SEARCHING


def _why_none(evaluator: PairEvaluator, pairs: Sequence[int]) -> str:
    rows = [evaluator.row((pair, probe)) for pair in pairs for probe in probes()]
    statuses = [str(row["status"]) for row in rows if row is not None]
    messages = [str(row["message"]) for row in rows if row is not None and row["message"]]
    if statuses and all(status == "no_keypoints" for status in statuses):
        return (
            "the images are blank: neither SIFT nor GFTT_H nor AKAZE finds a keypoint in any pair; "
            "check exposure and files, or try --equalize clahe"
        )
    if statuses and all(status == "error" for status in statuses):
        return f"no pair could be measured: {messages[0] if messages else 'unknown error'}"
    return (
        f"no two images of the {len(pairs)} pairs that were tried show the same things: none of "
        f"{', '.join(PROBES)} finds a model better than chance; check that the pairs overlap, or "
        "choose others with --pairs exhaustive or gps"
    )
