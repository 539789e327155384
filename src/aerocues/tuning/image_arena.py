"""Images as an arena: combinations are measured on pairs, until time is up."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from aerocues.evaluation.engine import Activity, Engine
from aerocues.evaluation.metrics import Row
from aerocues.methods.combination import Combination
from aerocues.scoring.combinations import SUCCESS
from aerocues.scoring.criteria import Criterion
from aerocues.scoring.long_form import values_of
from aerocues.tuning.bench import Bench
from aerocues.tuning.costs import Costs
from aerocues.tuning.device import Device
from aerocues.tuning.journal import Journal
from aerocues.tuning.race import Cell
from aerocues.tuning.scales import Array

if TYPE_CHECKING:
    import polars as pl

COMPONENTS = ("detector", "descriptor", "norm", "matcher")


class ImageArena:
    """Measures combinations on the pairs of a bench; see `race.Arena`.

    What its journal tells of an earlier, interrupted race is gone through again without measuring,
    so that the same decisions are taken.

    Parameters
    ----------
    bench : Bench
    engine : Engine
    combinations : sequence of Combination
    pairs : sequence of int
        Numbers of the pairs.
    criteria : sequence of Criterion
    journal : Journal
    budget : float
        Wall seconds, those that the journal has recorded among them.
    device : Device, optional
        Whose times count, in place of this machine's.
    watch : callable, optional
        Told what the workers are doing.
    """

    def __init__(
        self,
        bench: Bench,
        engine: Engine,
        combinations: Sequence[Combination],
        pairs: Sequence[int],
        criteria: Sequence[Criterion],
        journal: Journal,
        budget: float,
        *,
        began: float | None = None,
        device: Device | None = None,
        watch: Callable[[Sequence[Activity]], None] = lambda _: None,
    ) -> None:
        self.alternatives: Sequence[str] = [str(combination) for combination in combinations]
        self.components: Mapping[str, Sequence[str]] = {
            name: [getattr(each, name) for each in combinations] for name in COMPONENTS
        }
        self.blocks = _blocks(bench, pairs)
        self.criteria = criteria
        self.spent = 0.0
        self._bench, self._engine, self._watch = bench, engine, watch
        self._combinations, self._pairs = combinations, pairs
        self._journal, self._budget, self._device = journal, budget, device
        self._recorded = list(journal.steps)
        self._began = (time.monotonic() if began is None else began) - journal.spent
        self._costs = Costs(bench.context.methods, combinations)
        self.predicted_seconds = self._costs.predicted()

    def measure(self, cells: Sequence[Cell]) -> dict[Cell, Array]:
        measurements = [(self._pairs[p], self._combinations[a]) for a, p in cells]
        asked = [each for each in measurements if self._bench.possible(each)]
        if self._recorded:
            self.spent, missing = self._recorded.pop(0)
        else:
            missing = self._work(asked)
        rows = {
            cell: self._bench.row(each)
            for cell, each in zip(cells, measurements, strict=True)
            if self._bench.possible(each) and self._bench.row_key(each) not in missing
        }
        return self._values({cell: row for cell, row in rows.items() if row is not None})

    def _work(self, asked: Sequence[tuple[int, Combination]]) -> list[str]:
        """Measure, and give back the keys of the rows that were not obtained in time."""
        deadline = self._began + self._budget
        finished = False
        try:
            self._bench.measure(asked, self._engine, deadline=deadline, watch=self._watch)
            finished = True
        finally:
            self.spent = time.monotonic() - self._began
            if not finished:
                self._journal.interrupt(self.spent)
        missing = [self._bench.row_key(each) for each in asked if self._bench.row(each) is None]
        self._journal.add(self.spent, missing)
        return missing

    def _values(self, rows: dict[Cell, Row]) -> dict[Cell, Array]:
        if not rows:
            return {}
        for row in rows.values():
            self._costs.learn(row)
        self.predicted_seconds = self._costs.predicted()
        known = [self._device.there(row) if self._device else row for row in rows.values()]
        values = criterion_values(known, self.criteria)
        return dict(zip(rows, values, strict=True))


def criterion_values(rows: Sequence[Row], criteria: Sequence[Criterion]) -> Array:
    """(N, C) values of the criteria in measured rows; NaN in all of a row that failed."""
    frame = rows_frame(rows)
    columns = [
        values_of(frame, criterion).cast(float).fill_null(float("nan")).to_numpy()
        for criterion in criteria
    ]
    values = np.stack(columns, axis=1)
    failed = ~frame["status"].is_in(SUCCESS).to_numpy() | ~np.isfinite(values).all(axis=1)
    values[failed] = np.nan
    return np.asarray(values, np.float64)


def rows_frame(rows: Sequence[Row]) -> pl.DataFrame:
    """Measured rows as a table."""
    import polars as pl

    from aerocues.evaluation.schema import polars_schema

    return pl.DataFrame(rows, schema=polars_schema(), orient="row")


def _blocks(bench: Bench, pairs: Sequence[int]) -> NDArray[np.int64]:
    sequences = [bench.context.dataset.pair(pair).sequence for pair in pairs]
    return np.unique(sequences, return_inverse=True)[1].astype(np.int64)
