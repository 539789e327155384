"""A unit of work: one detector on a run of consecutive pairs; and how it is split on failure."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

from aerocues.datasets.dataset import Dataset
from aerocues.evaluation.protocol import MeasurementProtocol
from aerocues.methods.combination import Combination
from aerocues.methods.registry import Methods


@dataclass(frozen=True)
class PairWork:
    """The combinations to evaluate on one pair, with the key of each row."""

    pair: int
    combinations: tuple[Combination, ...]
    row_keys: tuple[str, ...]

    def only(self, combinations: frozenset[Combination], *, keep: bool) -> PairWork:
        """The same work with, or without, the given combinations."""
        kept = [
            (combination, key)
            for combination, key in zip(self.combinations, self.row_keys, strict=True)
            if (combination in combinations) == keep
        ]
        return replace(
            self,
            combinations=tuple(combination for combination, _ in kept),
            row_keys=tuple(key for _, key in kept),
        )


@dataclass(frozen=True)
class Unit:
    """One detector on consecutive pairs; the features of an image are shared among them.

    ``alone`` asks for a fresh process, of which nothing else can have harmed the memory. ``cost``
    is an estimate in CPU seconds.
    """

    detector: str
    work: tuple[PairWork, ...]
    cost: float = 0.0
    alone: bool = False

    @property
    def rows(self) -> int:
        return sum(len(work.combinations) for work in self.work)

    def parts(self, *positions: int) -> list[Unit]:
        """The unit cut before the pairs at the given positions; parts may be empty."""
        bounds = (0, *positions, len(self.work))
        share = self.cost / len(self.work)
        return [
            replace(self, work=self.work[start:end], cost=share * (end - start))
            for start, end in pairwise(bounds)
        ]


@dataclass(frozen=True)
class StageCall:
    """The call that a worker is in: what to blame if the process does not survive it."""

    stage: str
    pair: int
    image: str
    detector: str
    descriptor: str = ""
    combination: str = ""

    def __str__(self) -> str:
        method = self.combination or "-".join(filter(None, (self.detector, self.descriptor)))
        return f"{self.stage} {method} on {self.image}"


@dataclass(frozen=True)
class Context:
    """What every unit of a run shares; sent to each worker once."""

    dataset: Dataset
    methods: Methods
    preset: str
    protocol: MeasurementProtocol
    settings_key: str
    machine: str


def blamed(work: PairWork, call: StageCall | None) -> frozenset[Combination]:
    """The combinations of a pair that cannot be had because `call` did not return."""
    if call is None or call.pair != work.pair or call.stage not in ("describe", "match", "verify"):
        return frozenset(work.combinations)
    if call.stage == "describe":
        return frozenset(c for c in work.combinations if c.descriptor == call.descriptor)
    return frozenset(c for c in work.combinations if str(c) == call.combination)


def split(unit: Unit, call: StageCall | None, *, certain: bool) -> tuple[list[Unit], Unit | None]:
    """Divide a unit whose worker was lost in `call`.

    Parameters
    ----------
    unit : Unit
    call : StageCall or None
        The call that did not return, where it is known.
    certain : bool
        Whether the call itself is to blame. A process that died may also have been harmed by what
        it did before: the pair is then tried once more alone.

    Returns
    -------
    remaining : list of Unit
        What is to be tried again, each in a process of its own.
    guilty : Unit or None
        What is given up.
    """
    position = next((i for i, work in enumerate(unit.work) if call and work.pair == call.pair), 0)
    before, pair, after = unit.parts(position, position + 1)
    remaining = [replace(part, alone=True) for part in (before, after) if part.work]
    if not (certain or (unit.alone and not remaining)):
        return [replace(pair, alone=True), *remaining], None
    work = pair.work[0]
    guilty = blamed(work, call)
    rest = work.only(guilty, keep=False)
    if rest.combinations:
        remaining.insert(0, replace(pair, work=(rest,), alone=True))
    return remaining, replace(pair, work=(work.only(guilty, keep=True),))
