"""From a dataset and combinations to units of work, leaving out what is in the store already."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import islice

from aerocues.datasets.dataset import Pair
from aerocues.evaluation.cost import estimate_pair_seconds
from aerocues.evaluation.unit import Context, PairWork, Unit
from aerocues.methods.combination import Combination

PAIRS_PER_UNIT = 5
KEY_LENGTH = 32


def content_hash(content: object) -> str:
    """Hexadecimal hash of anything that JSON can write."""
    text = json.dumps(content, sort_keys=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()[:KEY_LENGTH]


@dataclass(frozen=True)
class Exclusion:
    """A combination that some pairs of a dataset rule out, and why."""

    combination: Combination
    reason: str
    pairs: int


@dataclass(frozen=True)
class Plan:
    """Units to be done, rows that are there already, and what the images rule out."""

    units: tuple[Unit, ...]
    rows_planned: int
    rows_present: int
    exclusions: tuple[Exclusion, ...]

    @property
    def rows_left(self) -> int:
        return sum(unit.rows for unit in self.units)


def _row_key(
    context: Context,
    pair: Pair,
    combination: Combination,
    image_keys: dict[str, str],
    method_keys: dict[Combination, str],
) -> str:
    truth = None if pair.homography is None else pair.homography.tolist()
    return content_hash(
        [
            context.settings_key,
            method_keys[combination],
            str(combination),
            [context.dataset.name, pair.sequence, pair.index, pair.image_1, pair.image_2],
            [image_keys[pair.image_1], image_keys[pair.image_2]],
            truth,
        ]
    )


def _groups(pairs: Sequence[Pair]) -> Iterator[list[Pair]]:
    """Runs of consecutive pairs, cut where the sequence changes."""
    by_sequence: list[list[Pair]] = []
    for pair in pairs:
        if by_sequence and by_sequence[-1][-1].sequence == pair.sequence:
            by_sequence[-1].append(pair)
        else:
            by_sequence.append([pair])
    for group in by_sequence:
        rest = iter(group)
        while part := list(islice(rest, PAIRS_PER_UNIT)):
            yield part


def _gray_reason(context: Context, combination: Combination) -> str | None:
    if not context.methods.descriptors[combination.descriptor].needs_colour:
        return None
    return f"{combination.descriptor} needs three colour channels, and images are gray"


def make_plan(
    context: Context,
    combinations: Sequence[Combination],
    is_present: Callable[[str], bool],
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> Plan:
    """Divide the work into units, the costliest first.

    Parameters
    ----------
    context : Context
    combinations : sequence of Combination
        Runnable ones.
    is_present : callable
        Whether the row with a given key is in the store.
    progress : callable
        Told how many of all images have been read for their hashes.

    Raises
    ------
    ImageError
        If a file cannot be read at all.
    """
    dataset = context.dataset
    image_keys: dict[str, str] = {}
    for done, image in enumerate(dataset.images):
        image_keys[image.name] = image.source.content_key()
        progress(done + 1, len(dataset.images))
    gray = {image.name for image in dataset.images if image.source.is_gray()}
    method_keys = {c: content_hash(context.methods.parameters(c)) for c in combinations}
    units: list[Unit] = []
    planned = present = 0
    ruled_out: dict[tuple[Combination, str], int] = {}
    for group in _groups(dataset.pairs):
        for detector in dict.fromkeys(c.detector for c in combinations):
            work: list[PairWork] = []
            for pair in group:
                todo: list[tuple[Combination, str]] = []
                for combination in (c for c in combinations if c.detector == detector):
                    reason = _gray_reason(context, combination)
                    if reason and (pair.image_1 in gray or pair.image_2 in gray):
                        key = (combination, reason)
                        ruled_out[key] = ruled_out.get(key, 0) + 1
                        continue
                    planned += 1
                    row_key = _row_key(context, pair, combination, image_keys, method_keys)
                    if is_present(row_key):
                        present += 1
                    else:
                        todo.append((combination, row_key))
                if todo:
                    chosen, keys = zip(*todo, strict=True)
                    work.append(PairWork(pair.index, chosen, keys))
            if work:
                cost = sum(
                    estimate_pair_seconds(context.methods, detector, part.combinations)
                    for part in work
                )
                units.append(Unit(detector, tuple(work), cost))
    units.sort(key=lambda unit: -unit.cost)
    exclusions = tuple(
        Exclusion(combination, reason, pairs) for (combination, reason), pairs in ruled_out.items()
    )
    return Plan(tuple(units), planned, present, exclusions)
