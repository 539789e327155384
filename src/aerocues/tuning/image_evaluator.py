"""Evaluates the criteria of combinations on pairs of images, within a budget of time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from aerocues.evaluation.engine import Engine
from aerocues.methods.combination import Combination
from aerocues.results.combination_columns import METHODS
from aerocues.results.metrics import Row
from aerocues.scoring.combinations import SUCCESS
from aerocues.scoring.criteria import Criterion
from aerocues.scoring.long_form import values_of
from aerocues.tuning.costs import Costs
from aerocues.tuning.criteria_evaluator import Cell
from aerocues.tuning.device import Device
from aerocues.tuning.layout import blocks_of
from aerocues.tuning.pair_evaluator import PairEvaluator
from aerocues.tuning.scales import Array
from aerocues.tuning.session import Session

if TYPE_CHECKING:
    import polars as pl


class ImageEvaluator:
    """A `CriteriaEvaluator` of combinations on pairs of images.

    Parameters
    ----------
    evaluator : PairEvaluator
    engine : Engine
    combinations : sequence of Combination
    pairs : sequence of int
        Numbers of the pairs.
    criteria : sequence of Criterion
    session : Session
        Keeps the budget.
    device : Device, optional
        Use the times of this device in place of this machine's.
    """

    def __init__(
        self,
        evaluator: PairEvaluator,
        engine: Engine,
        combinations: Sequence[Combination],
        pairs: Sequence[int],
        criteria: Sequence[Criterion],
        session: Session,
        device: Device | None = None,
    ) -> None:
        self.alternatives: Sequence[str] = [str(combination) for combination in combinations]
        self.components: Mapping[str, Sequence[str]] = {
            name: [getattr(each, name) for each in combinations] for name in METHODS
        }
        self.blocks = blocks_of([evaluator.context.dataset.pair(pair) for pair in pairs])
        self.classes = evaluator.classes_of(pairs)
        self.criteria = criteria
        self._evaluator, self._engine, self._session = evaluator, engine, session
        self._combinations, self._pairs, self._device = combinations, pairs, device
        self._costs = Costs(evaluator.context.methods, combinations)
        self._has_measured = False
        self.predicted_seconds = self._costs.predicted()

    @property
    def spent(self) -> float:
        """Wall seconds of the session, including those reserved for the end."""
        return self._session.spent

    def given(self) -> dict[Cell, Array]:
        """Values of the cells that were there when the race began, such as for other objectives."""
        cells = {
            (a, p): self._evaluator.row((pair, combination))
            for a, combination in enumerate(self._combinations)
            for p, pair in enumerate(self._pairs)
        }
        return self._values(
            {
                cell: row
                for cell, row in cells.items()
                if row is not None and row["row_key"] in self._session.given
            }
        )

    def measure(self, cells: Sequence[Cell], keep: float = 0.0) -> dict[Cell, Array]:
        """Values of the cells that were measured in time; see `CriteriaEvaluator`.

        Raises
        ------
        SelectionError
            If the time was up before anything was measured.
        """
        measurements = [(self._pairs[p], self._combinations[a]) for a, p in cells]
        asked = [each for each in measurements if self._evaluator.possible(each)]
        missing = self._session.measure(self._evaluator, self._engine, asked, keep=keep)
        rows = {
            cell: self._evaluator.row(each)
            for cell, each in zip(cells, measurements, strict=True)
            if self._evaluator.possible(each) and self._evaluator.row_key(each) not in missing
        }
        self._has_measured |= bool(rows)
        if missing and not self._has_measured:
            raise self._session.too_small(
                "images that show the same things were found, but no combination could be "
                "measured on them in time"
            )
        return self._values({cell: row for cell, row in rows.items() if row is not None})

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
    """(N, C) values of the criteria in measured rows; all NaN for a row that failed."""
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

    from aerocues.results.schema import polars_schema

    return pl.DataFrame(rows, schema=polars_schema(), orient="row")
