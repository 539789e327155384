"""Selects the measured row that counts for each planned row."""

from __future__ import annotations

from typing import TYPE_CHECKING

from aerocues.results.plan_table import IDENTITY_NAMES
from aerocues.results.scaled_times import COLUMNS, with_scaled_times
from aerocues.results.schema import polars_schema
from aerocues.results.statuses import RETRIED
from aerocues.results.timing import TIMINGS

if TYPE_CHECKING:
    import polars as pl


def best_rows(planned: pl.DataFrame, measured: pl.DataFrame) -> pl.DataFrame:
    """The measured rows of the plan, each once and in order.

    If a row was measured several times, successful measurements come before failed ones, better
    timings before worse ones (`timing.TIMINGS`), and then the latest. If other rows of the
    combination were timed exclusively, its times are scaled (`scaled_times`).

    Parameters
    ----------
    planned : pl.DataFrame
        Made by `planned_rows.planned_table`.
    measured : pl.DataFrame
        Columns as in `schema.COLUMNS`, with the names of the rows when they were measured.

    Returns
    -------
    pl.DataFrame
        Columns as in `schema.COLUMNS`, with the names of the rows in the plan; sorted by them.
    """
    import polars as pl

    # Full rows are read last: there may be a million rows with seventy columns.
    keys = measured.select("row_key", "status", "timing", "measured_at").with_row_index("place")
    keys = keys.join(planned.select("row_key"), on="row_key", how="semi", maintain_order="left")
    best = (
        keys.sort(
            ~pl.col("status").is_in(RETRIED),
            pl.col("timing").replace_strict(
                {name: rank for rank, name in enumerate(TIMINGS)}, default=-1
            ),
            "measured_at",
            nulls_last=False,
            maintain_order=True,
        )
        .unique("row_key", keep="last", maintain_order=True)
        .select("row_key", "place")
    )
    named = planned.select(*IDENTITY_NAMES, "row_key").join(best, on="row_key")
    named = named.sort(IDENTITY_NAMES)
    rows = measured[named["place"]].with_columns(named.select(IDENTITY_NAMES).get_columns())
    succeeded = keys.filter(~pl.col("status").is_in(RETRIED))["place"]
    timed = with_scaled_times(rows, measured.select(COLUMNS)[succeeded])
    return timed.select(list(polars_schema()))
