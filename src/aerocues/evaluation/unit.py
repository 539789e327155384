"""A unit of work: one detector on consecutive pairs, and how it is split on failure."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

from aerocues.datasets.dataset import Dataset
from aerocues.methods.combination import Combination
from aerocues.methods.registry import Methods
from aerocues.pipeline.protocol import MeasurementProtocol
from aerocues.processes.call import StageCall
from aerocues.results.timing import Timing


@dataclass(frozen=True)
class PairWork:
    """The combinations to evaluate on one pair, with the key of each row."""

    pair: int
    combinations: tuple[Combination, ...]
    row_keys: tuple[str, ...]

    def only(self, combinations: frozenset[Combination], *, keep: bool) -> PairWork:
        """The same work with only, or without, the given combinations."""
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
    """One detector on consecutive pairs, which share the features of images.

    ``alone`` requires a new process, whose memory cannot have been corrupted before. ``cost`` is an
    estimate in CPU seconds.
    """

    detector: str
    work: tuple[PairWork, ...]
    cost: float = 0.0
    alone: bool = False

    @property
    def rows(self) -> int:
        return sum(len(work.combinations) for work in self.work)

    def parts(self, *positions: int) -> list[Unit]:
        """The unit split before the pairs at the given positions; parts may be empty."""
        bounds = (0, *positions, len(self.work))
        share = self.cost / len(self.work)
        return [
            replace(self, work=self.work[start:end], cost=share * (end - start))
            for start, end in pairwise(bounds)
        ]


@dataclass(frozen=True)
class Context:
    """The context that all units of a run share; it is sent to each worker once.

    ``features`` is an optional folder in which features are stored for other runs, and
    ``references`` one in which the workers share the references of pairs.
    """

    dataset: Dataset
    methods: Methods
    preset: str
    protocol: MeasurementProtocol
    settings_key: str
    machine: str
    features: Path | None = None
    references: Path | None = None

    def timed(self, timing: Timing) -> Context:
        """The same context with another timing, which does not change row keys."""
        return replace(self, protocol=replace(self.protocol, timing=timing))


def _blamed(work: PairWork, call: StageCall, pairs: frozenset[int]) -> frozenset[Combination]:
    """The combinations of a pair that are blocked because `call` does not return."""
    if work.pair not in pairs:
        return frozenset()
    if call.stage in ("detect", "reference"):
        return frozenset(work.combinations)
    if call.stage == "describe":
        return frozenset(c for c in work.combinations if c.descriptor == call.descriptor)
    return frozenset(c for c in work.combinations if str(c) == call.combination)


def split(
    unit: Unit, call: StageCall | None, *, certain: bool, pairs: frozenset[int] | None = None
) -> tuple[list[Unit], Unit | None]:
    """Divide a unit whose worker was lost in `call`.

    Parameters
    ----------
    unit : Unit
    call : StageCall or None
        The call that did not return, if known.
    certain : bool
        Whether the call itself is the cause. A process that died may also have been damaged by
        earlier calls; the pair is then retried alone.
    pairs : frozenset of int, optional
        The pairs that need the result of the call, which are those of its image. By default only
        its own pair.

    Returns
    -------
    remaining : list of Unit
        What is to be tried again, each in a process of its own.
    guilty : Unit or None
        The part that is given up.
    """
    position = next((i for i, work in enumerate(unit.work) if call and work.pair == call.pair), 0)
    before, pair, after = unit.parts(position, position + 1)
    if not (certain or (unit.alone and len(unit.work) == 1)):
        others = [replace(part, alone=True) for part in (before, after) if part.work]
        return [replace(pair, alone=True), *others], None
    lost: dict[int, frozenset[Combination]] = {}
    if call is not None:
        needing = pairs or frozenset({call.pair})
        lost = {work.pair: _blamed(work, call, needing) for work in unit.work}
    if not any(lost.values()):
        lost = {pair.work[0].pair: frozenset(pair.work[0].combinations)}
    nothing: frozenset[Combination] = frozenset()
    guilty = [work.only(lost.get(work.pair, nothing), keep=True) for work in unit.work]
    innocent = [work.only(lost.get(work.pair, nothing), keep=False) for work in unit.work]
    left = tuple(work for work in innocent if work.combinations)
    remaining = [replace(unit, work=left, alone=True)] if left else []
    return remaining, replace(unit, work=tuple(work for work in guilty if work.combinations))
