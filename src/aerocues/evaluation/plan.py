"""Plans units of work from a dataset and combinations, without what is already stored."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import islice

from aerocues.datasets.dataset import Dataset, Pair
from aerocues.evaluation.cost import costly_descriptors, estimate_pair_seconds
from aerocues.evaluation.planned_rows import PlannedRow
from aerocues.evaluation.unit import Context, PairWork, Unit
from aerocues.methods.combination import Combination
from aerocues.results.hashing import content_hash

PAIRS_PER_UNIT = 5


@dataclass(frozen=True)
class Exclusion:
    """A combination that cannot run on some pairs of a dataset, and why."""

    combination: Combination
    reason: str
    pairs: int


@dataclass(frozen=True)
class Plan:
    """Units to run, all planned rows, and excluded combinations."""

    units: tuple[Unit, ...]
    rows: tuple[PlannedRow, ...]
    exclusions: tuple[Exclusion, ...]

    @property
    def rows_planned(self) -> int:
        return len(self.rows)

    @property
    def rows_present(self) -> int:
        return self.rows_planned - self.rows_left

    @property
    def rows_left(self) -> int:
        return sum(unit.rows for unit in self.units)


@dataclass(frozen=True)
class _Keys:
    """Hashes of the input: images and, if known, their true views."""

    images: Mapping[str, str]
    views: Mapping[str, str]

    def seen(self, dataset: Dataset, name: str) -> object:
        """The part that an image decides: its content, and how it is turned."""
        turn = dataset.image(name).turn
        return [self.images[name], turn] if turn else self.images[name]

    def truth(self, pair: Pair) -> object:
        """The part of the key of a pair that its ground truth decides; None without truth."""
        if pair.homography is not None:
            return pair.homography.tolist()
        views = [self.views.get(name) for name in (pair.image_1, pair.image_2)]
        return None if None in views else views


def _row_key(
    context: Context, pair: Pair, combination: Combination, keys: _Keys, method_key: str
) -> str:
    """Hash of everything that the measurement depends on, without names and numbers."""
    return content_hash(
        [
            context.settings_key,
            context.dataset.geometry,
            method_key,
            [keys.seen(context.dataset, name) for name in (pair.image_1, pair.image_2)],
            keys.truth(pair),
        ]
    )


def _groups(pairs: Sequence[Pair]) -> Iterator[list[Pair]]:
    """Runs of consecutive pairs, split where the sequence changes."""
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
    return f"{combination.descriptor} needs three colour channels, but the images are gray"


@dataclass
class _Tally:
    """Counts that are updated while the work is divided."""

    rows: list[PlannedRow] = field(default_factory=list)
    ruled_out: Counter[tuple[Combination, str]] = field(default_factory=Counter)


def _method_key(context: Context, combination: Combination) -> str:
    parameters = context.methods.parameters(combination)
    threshold = context.protocol.threshold(combination)
    own = threshold != context.protocol.verification.threshold
    return content_hash([parameters, threshold] if own else parameters)


class _Planner:
    """Divides the work on one dataset."""

    def __init__(
        self,
        context: Context,
        combinations: Sequence[Combination],
        keys: _Keys,
        is_present: Callable[[str], bool],
    ) -> None:
        self._context = context
        self._keys = keys
        self._is_present = is_present
        self._gray = {image.name for image in context.dataset.images if image.source.is_gray()}
        self._method_keys = {c: _method_key(context, c) for c in combinations}
        self.tally = _Tally()

    def units(self, detector: str, group: Sequence[Pair]) -> Iterator[Unit]:
        """The remaining work of a detector on consecutive pairs.

        Expensive descriptors get their own units, so that they are distributed over the workers.
        """
        methods = self._context.methods
        combinations = [c for c in self._method_keys if c.detector == detector]
        work = [self._pair_work(pair, combinations) for pair in group]
        names = dict.fromkeys(c.descriptor for part in work for c in part.combinations)
        apart = costly_descriptors(methods, detector, names)
        for kept in (*([name] for name in apart), [name for name in names if name not in apart]):
            own = frozenset(c for c in combinations if c.descriptor in kept)
            parts = (part.only(own, keep=True) for part in work)
            left = tuple(part for part in parts if part.combinations)
            if left:
                cost = sum(estimate_pair_seconds(methods, detector, p.combinations) for p in left)
                yield Unit(detector, left, cost)

    def _pair_work(self, pair: Pair, combinations: Sequence[Combination]) -> PairWork:
        chosen: list[Combination] = []
        keys: list[str] = []
        is_gray = pair.image_1 in self._gray or pair.image_2 in self._gray
        for combination in combinations:
            reason = _gray_reason(self._context, combination) if is_gray else None
            if reason:
                self.tally.ruled_out[combination, reason] += 1
                continue
            method_key = self._method_keys[combination]
            key = _row_key(self._context, pair, combination, self._keys, method_key)
            self.tally.rows.append(PlannedRow(pair.index, combination, key))
            if not self._is_present(key):
                chosen.append(combination)
                keys.append(key)
        return PairWork(pair.index, tuple(chosen), tuple(keys))


def make_plan(
    context: Context,
    combinations: Sequence[Combination],
    is_present: Callable[[str], bool],
    progress: Callable[[int, int], None] = lambda done, total: None,
    pairs: frozenset[int] | None = None,
) -> Plan:
    """Divide the work into units, the most expensive first.

    Parameters
    ----------
    context : Context
    combinations : sequence of Combination
        Runnable combinations.
    is_present : callable
        Returns whether the row with a given key is stored.
    progress : callable
        Called with the number of images that were read for their hashes, and the total.
    pairs : frozenset of int, optional
        Numbers of the pairs to plan for; all by default.

    Raises
    ------
    ImageError
        If a file cannot be read.
    """
    images = context.dataset.images
    keys, views = dict[str, str](), dict[str, str]()
    for done, image in enumerate(images, start=1):
        keys[image.name] = image.source.content_key()
        if image.truth is not None:
            views[image.name] = content_hash(image.truth.identity())
        progress(done, len(images))
    planner = _Planner(context, combinations, _Keys(keys, views), is_present)
    detectors = dict.fromkeys(combination.detector for combination in combinations)
    units = [
        unit
        for group in _groups(
            [p for p in context.dataset.pairs if pairs is None or p.index in pairs]
        )
        for detector in detectors
        for unit in planner.units(detector, group)
    ]
    units.sort(key=lambda unit: -unit.cost)
    tally = planner.tally
    exclusions = tuple(
        Exclusion(combination, reason, pairs)
        for (combination, reason), pairs in tally.ruled_out.items()
    )
    return Plan(tuple(units), tuple(tally.rows), exclusions)
