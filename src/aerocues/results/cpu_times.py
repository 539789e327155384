"""Rows whose times are CPU times, as programs beside a measurement change wall times."""

from __future__ import annotations

from typing import TYPE_CHECKING

from aerocues.results.metrics import METRICS
from aerocues.results.schema import TIMES

if TYPE_CHECKING:
    import polars as pl

CPU = "_cpu"
OF_WALL_TIMES = ("timing_spread", "wall_over_cpu")
"""What is told of wall times alone."""


def with_cpu_times(rows: pl.DataFrame) -> pl.DataFrame:
    """Rows with the CPU time of each stage as its time, and the metrics that follow from it.

    A stage of one thread takes its CPU time where nothing else runs; its wall time on a shared core
    is up to several times that. What was told of wall times becomes null; where only totals are
    known, as in imported rows, they stay. A stage that works on another device takes longer than
    its CPU time.

    Parameters
    ----------
    rows : pl.DataFrame
        Columns as in `schema.COLUMNS`.
    """
    import polars as pl

    stages = [column.name for column in TIMES if not column.name.endswith(CPU)]
    timed = rows.with_columns(
        *(pl.coalesce(f"{stage}{CPU}", stage).alias(stage) for stage in stages),
        *(pl.lit(None).cast(rows.schema[name]).alias(name) for name in OF_WALL_TIMES),
    )
    of_times = [metric for metric in METRICS if "seconds" in metric.name]
    every = timed.to_dicts()
    return timed.with_columns(
        pl.coalesce(
            pl.Series(metric.name, [metric.compute(row) for row in every], dtype=pl.Float64),
            metric.name,
        )
        for metric in of_times
    )
