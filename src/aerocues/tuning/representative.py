"""Which pairs stand for all of a data set: spread over it, and seen to show the same things."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from aerocues.datasets.dataset import Pair
from aerocues.errors import DatasetError
from aerocues.evaluation.engine import Engine
from aerocues.methods.combination import Combination
from aerocues.tuning.bench import Bench

MOST_PAIRS = 24
# Strong ones of different kinds, quick to run; a pair on which all fail is taken to share nothing.
PROBES = ("SIFT-SIFT-L2-FLANN", "GFTT_H-BRIEF-HAM-BF", "AKAZE-AKAZE-HAM-BF")


@dataclass(frozen=True)
class Seen:
    """Numbers of the pairs whose images show the same things, and of those where none was seen."""

    overlapping: tuple[int, ...]
    others: tuple[int, ...]


def spread_pairs(pairs: Sequence[Pair], most: int = MOST_PAIRS) -> list[Pair]:
    """At most so many pairs, evenly spread over each sequence, each sequence by its share.

    Every sequence keeps one pair at least, however many there are.
    """
    if len(pairs) <= most:
        return list(pairs)
    sequences: dict[str, list[Pair]] = {}
    for pair in pairs:
        sequences.setdefault(pair.sequence, []).append(pair)
    chosen: list[Pair] = []
    for own in sequences.values():
        count = max(round(most * len(own) / len(pairs)), 1)
        places = np.linspace(0, len(own) - 1, count + 2)[1:-1] if count < len(own) else None
        chosen += own if places is None else [own[round(place)] for place in places]
    return chosen


def probes() -> list[Combination]:
    """The combinations that tell whether two images show the same things."""
    return [Combination.parse(name) for name in PROBES]


def look_for_overlap(bench: Bench, engine: Engine, pairs: Sequence[Pair]) -> Seen:
    """Tell which pairs show the same things: some probe finds a model that is no chance.

    Raises
    ------
    DatasetError
        If no pair does: its message says whether images are blank or do not overlap.
    """
    open_questions = [pair.index for pair in pairs]
    for probe in probes():
        asked = [(pair, probe) for pair in open_questions if bench.possible((pair, probe))]
        bench.measure(asked, engine)
        open_questions = [pair for pair in open_questions if not _is_ok(bench, pair, probe)]
    unseen = tuple(open_questions)
    overlapping = tuple(pair.index for pair in pairs if pair.index not in unseen)
    if not overlapping:
        raise DatasetError(_why_none(bench, unseen))
    return Seen(overlapping, unseen)


def _is_ok(bench: Bench, pair: int, probe: Combination) -> bool:
    row = bench.row((pair, probe))
    return row is not None and row["status"] == "ok"


def _why_none(bench: Bench, pairs: Sequence[int]) -> str:
    rows = [bench.row((pair, probe)) for pair in pairs for probe in probes()]
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
