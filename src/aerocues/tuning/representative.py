"""Representative pairs of a dataset: evenly spread, and with overlapping images."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from aerocues.datasets.dataset import Pair
from aerocues.defaults import RACE_PAIRS
from aerocues.errors import DatasetError
from aerocues.evaluation.engine import Engine
from aerocues.methods.combination import Combination
from aerocues.tuning.layout import blocks_of, spread_order
from aerocues.tuning.pair_evaluator import PairEvaluator
from aerocues.tuning.session import Session

# One pair says too little about the others.
FEWEST_PAIRS = 2
# Strong combinations of different kinds that run fast; a pair on which all fail has no overlap.
PROBES = ("SIFT-SIFT-L2-FLANN", "GFTT_H-BRIEF-HAM-BF", "AKAZE-AKAZE-HAM-BF")
# Pairs are tested in groups: the first 2, the next 6, then the rest. If time is short, the race
# uses the tested groups; larger groups keep more workers busy.
FIRST, SECOND = 2, 8
# Shares of the budget for testing overlap, and for finding two overlapping pairs at all. Larger
# shares test more pairs, and leave less time for the race.
TESTING, SEARCHING = 0.25, 0.6


@dataclass(frozen=True)
class Seen:
    """Numbers of the pairs whose images overlap, and of the others.

    `unseen` are the pairs for which there was no time, `referenced` those that overlap and have a
    reference, which tells right matches. `failed` are pairs that cannot be measured, with the
    reason: an image that is damaged.
    """

    overlapping: tuple[int, ...]
    others: tuple[int, ...]
    unseen: tuple[int, ...] = ()
    referenced: tuple[int, ...] = ()
    failed: tuple[tuple[int, str], ...] = ()


def spread_pairs(pairs: Sequence[Pair], most: int = RACE_PAIRS, seed: int = 0) -> list[Pair]:
    """At most `most` pairs, evenly spread; each sequence contributes in proportion to its size.

    Every sequence keeps at least one pair. If there are more than `most` sequences, one of each
    group of neighbours is drawn at random.
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
    """The combinations that test whether two images overlap."""
    return [Combination.parse(name) for name in PROBES]


def find_overlap(
    evaluator: PairEvaluator, engine: Engine, pairs: Sequence[Pair], session: Session, seed: int = 0
) -> Seen:
    """Find the pairs that overlap: those on which a probe finds a model that beats chance.

    If a quarter of what is left of the budget is not enough for all pairs, an evenly spread part of
    them is tested.
    The test may take longer only until two overlapping pairs are found.

    Parameters
    ----------
    evaluator : PairEvaluator
        Its protocol must have the test against chance.
    engine : Engine
    pairs : sequence of Pair
    session : Session
    seed : int

    Raises
    ------
    DatasetError
        If no pair overlaps; the message says whether images are blank or do not overlap.
    SelectionError
        If the time was up before one was found.
    """
    order = spread_order(blocks_of(pairs), np.random.default_rng(seed))
    spread = [pairs[place].index for place in order]
    test = _OverlapTest(evaluator, engine, session)
    for start, end in ((0, FIRST), (FIRST, SECOND), (SECOND, len(spread))):
        test.run(spread[start:end])
    overlapping, others, unseen = (
        tuple(pair.index for pair in pairs if pair.index in found)
        for found in (test.overlapping, test.others, test.unseen)
    )
    seen = Seen(overlapping, others, unseen)
    if seen.overlapping:
        return _without_failed(evaluator, seen)
    if seen.unseen:
        raise session.too_small(
            "no overlapping images were found in time, and "
            f"{len(seen.others)} of {len(pairs)} pairs were tested"
        )
    raise DatasetError(_why_none(evaluator, seen.others))


@dataclass
class _OverlapTest:
    evaluator: PairEvaluator
    engine: Engine
    session: Session
    overlapping: set[int] = field(default_factory=set)
    others: set[int] = field(default_factory=set)
    unseen: set[int] = field(default_factory=set)
    begun: float = field(init=False)

    def __post_init__(self) -> None:
        self.begun = min(self.session.spent, self.session.budget)

    def run(self, pairs: Sequence[int]) -> None:
        """Test pairs with one probe after the other, each on the pairs still without a model."""
        left = list(pairs)
        for probe in probes():
            left = self._without_model(left, probe)
        self.others |= set(left) - self.unseen

    def _without_model(self, pairs: Sequence[int], probe: Combination) -> list[int]:
        asked = [(pair, probe) for pair in pairs if self.evaluator.possible((pair, probe))]
        if not asked:
            return list(pairs)
        until = self.begun + self._share() * (self.session.budget - self.begun)
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
        return TESTING if len(self.overlapping) >= FEWEST_PAIRS else SEARCHING


def _without_failed(evaluator: PairEvaluator, seen: Seen) -> Seen:
    """Tell pairs that cannot be measured from those that do not overlap."""
    failed = {}
    for pair in seen.others:
        rows = [evaluator.row((pair, probe)) for probe in probes()]
        if all(row is not None and row["status"] == "error" for row in rows):
            failed[pair] = next(str(row["message"]) for row in rows if row is not None)
    others = tuple(pair for pair in seen.others if pair not in failed)
    return replace(seen, others=others, failed=tuple(failed.items()))


def _why_none(evaluator: PairEvaluator, pairs: Sequence[int]) -> str:
    rows = [evaluator.row((pair, probe)) for pair in pairs for probe in probes()]
    statuses = [str(row["status"]) for row in rows if row is not None]
    messages = [str(row["message"]) for row in rows if row is not None and row["message"]]
    if statuses and all(status == "no_keypoints" for status in statuses):
        return (
            "the images are blank: neither SIFT nor GFTT_H nor AKAZE finds a keypoint in any pair; "
            'check exposure and files, or try `equalize="clahe"`'
        )
    if statuses and all(status == "error" for status in statuses):
        return f"no pair could be measured: {messages[0] if messages else 'unknown error'}"
    return (
        f"the images of the {len(pairs)} tested pairs do not overlap: none of "
        f"{', '.join(PROBES)} finds a model better than chance; check that the pairs overlap, or "
        'choose others with `pairs="exhaustive"` or `pairs="gps"`'
    )
