"""A unit of work: one detector on a run of consecutive pairs; and how it is split on failure."""

from __future__ import annotations

from dataclasses import dataclass, replace

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
    """One detector on consecutive pairs; the features of an image are shared among them."""

    detector: str
    work: tuple[PairWork, ...]
    cost: float = 0.0

    @property
    def rows(self) -> int:
        return sum(len(work.combinations) for work in self.work)


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


def split(unit: Unit, call: StageCall | None) -> tuple[list[Unit], Unit | None]:
    """Divide a unit whose worker died in `call`.

    Returns
    -------
    remaining : list of Unit
        What is to be tried again, each in a process of its own.
    guilty : Unit or None
        What is given up: only once the unit is down to the pair in which the worker died.
    """
    if len(unit.work) > 1:
        position = next(
            (i for i, work in enumerate(unit.work) if call and work.pair == call.pair), 0
        )
        groups = (
            unit.work[:position],
            unit.work[position : position + 1],
            unit.work[position + 1 :],
        )
        share = unit.cost / len(unit.work)
        return [
            replace(unit, work=group, cost=share * len(group)) for group in groups if group
        ], None
    work = unit.work[0]
    guilty = blamed(work, call)
    rest = work.only(guilty, keep=False)
    remaining = [replace(unit, work=(rest,))] if rest.combinations else []
    return remaining, replace(unit, work=(work.only(guilty, keep=True),))
