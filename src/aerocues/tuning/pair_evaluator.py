"""Evaluates single combinations on single pairs into a results folder, each once."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Iterable, Sequence
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from aerocues.evaluation.context import run_facts
from aerocues.evaluation.cost import estimate_pair_seconds
from aerocues.evaluation.engine import Engine
from aerocues.evaluation.plan import Plan, make_plan
from aerocues.evaluation.planned_rows import PlannedRow, planned_table
from aerocues.evaluation.unit import Context, PairWork, Unit
from aerocues.methods.combination import Combination
from aerocues.methods.presets import Preset
from aerocues.pipeline.reference import FLOW
from aerocues.progress import Activity
from aerocues.results.hashing import content_hash
from aerocues.results.metrics import Row
from aerocues.results.pair_classes import pair_class
from aerocues.results.store import Store

Measurement = tuple[int, Combination]
"""The number of a pair, and the combination to measure on it."""


class _TimeIsUpError(Exception):
    """Stops the workers at the deadline."""


class PairEvaluator:
    """Measures combinations on pairs, and keeps the rows.

    Parameters
    ----------
    context : Context
    combinations : sequence of Combination
        All that may be measured.
    store : Store
        Open for writing.
    preset : Preset
        Recorded with the results.
    hashing : callable
        Called with the number of images read and of all images.
    clock : callable
        Returns seconds; deadlines are in its time.
    """

    def __init__(
        self,
        context: Context,
        combinations: Sequence[Combination],
        store: Store,
        preset: Preset,
        hashing: Callable[[int, int], None] = lambda done, total: None,
        *,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.context = context
        self._clock = clock
        self._store = store
        self.plan: Plan = make_plan(context, combinations, lambda _: False, hashing)
        self._planned = {(row.pair, row.combination): row for row in self.plan.rows}
        self._dataset_key = content_hash([context.dataset.geometry, context.dataset.settings])
        keys = {row.row_key for row in self.plan.rows}
        self._rows: dict[str, Row] = {
            row["row_key"]: row
            for row in store.rows().sort("measured_at").iter_rows(named=True)
            if row["row_key"] in keys
        }
        store.write_run(run_facts(context, preset, self.plan, combinations))

    def possible(self, measurement: Measurement) -> bool:
        """Whether the images allow this measurement."""
        return measurement in self._planned

    def row(self, measurement: Measurement) -> Row | None:
        """The measured row; None if it was not measured."""
        planned = self._planned.get(measurement)
        return None if planned is None else self._rows.get(planned.row_key)

    @property
    def there(self) -> frozenset[str]:
        """Keys of the rows that were measured."""
        return frozenset(self._rows)

    def row_key(self, measurement: Measurement) -> str:
        return self._planned[measurement].row_key

    def measure(
        self,
        measurements: Iterable[Measurement],
        engine: Engine,
        *,
        deadline: float = float("inf"),
        watch: Callable[[Sequence[Activity]], None] = lambda _: None,
    ) -> None:
        """Measure what is missing; what is unfinished at the deadline is dropped.

        Parameters
        ----------
        measurements : iterable of Measurement
        engine : Engine
        deadline : float
            In seconds of the evaluator's clock.
        watch : callable
            Called with the activities of the workers.

        Raises
        ------
        AerocuesError
            If workers cannot be started or results cannot be written.
        """
        rows = [self._planned[each] for each in measurements]
        missing = [row for row in rows if row.row_key not in self._rows]
        if rows:
            self._store.write_plan(planned_table(self.context, self._dataset_key, rows))
        if not missing or self._clock() >= deadline:
            return

        def stop_in_time(activities: Sequence[Activity]) -> None:
            if self._clock() >= deadline:
                raise _TimeIsUpError
            watch(activities)

        with contextlib.suppress(_TimeIsUpError):
            self._run(self._units(missing), engine, stop_in_time)

    def _run(
        self, units: Sequence[Unit], engine: Engine, watch: Callable[[Sequence[Activity]], None]
    ) -> None:
        with contextlib.closing(engine.run(units, self.context, watch)) as finished_units:
            for finished in finished_units:
                self._store.write_finished(finished.unit.detector, finished.rows)
                self._rows.update((str(row["row_key"]), row) for row in finished.rows)

    def _units(self, rows: Sequence[PlannedRow]) -> list[Unit]:
        """One unit per detector and pair, the costliest first."""
        units = []
        order = sorted(rows, key=lambda row: (row.combination.detector, row.pair))
        for (detector, pair), group in groupby(
            order, key=lambda row: (row.combination.detector, row.pair)
        ):
            own = list(group)
            combinations = tuple(row.combination for row in own)
            work = PairWork(pair, combinations, tuple(row.row_key for row in own))
            cost = estimate_pair_seconds(self.context.methods, detector, combinations)
            units.append(Unit(detector, (work,), cost))
        return sorted(units, key=lambda unit: -unit.cost)

    def classes_of(self, pairs: Sequence[int]) -> NDArray[np.int64]:
        """(P,) 1 where the two images are turned against each other by their reference, else 0.

        Parameters
        ----------
        pairs : sequence of int
            Numbers of pairs; those on which nothing was measured yet count as not turned.
        """
        turns = {
            row["pair"]: row["reference_turn"]
            for row in self._rows.values()
            if row.get("reference_turn") is not None
        }
        turned = [pair_class(turns.get(pair, 0.0)) == "turned" for pair in pairs]
        return np.array(turned, np.int64)

    def without_reference(self) -> frozenset[int]:
        """Numbers of the measured pairs that have no reference: no match is known to be right."""
        found = [row for row in self._rows.values() if row.get("reference") is not None]
        having = {row["pair"] for row in found if row["reference"] == FLOW}
        return frozenset(row["pair"] for row in found) - having
