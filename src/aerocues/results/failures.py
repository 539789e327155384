"""The rows that failed, grouped by method."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import polars as pl


def failures_of(rows: pl.DataFrame) -> pl.DataFrame:
    """Count the rows whose status is not ``ok``, the most frequent kind first.

    Returns
    -------
    pl.DataFrame
        ``status, detector, descriptor, rows, message``: `message` is that of one of the rows.
    """
    import polars as pl

    return (
        rows.filter(pl.col("status") != "ok")
        .group_by("status", "detector", "descriptor")
        .agg(pl.len().alias("rows"), pl.col("message").drop_nulls().first())
        .sort("rows", "status", "detector", "descriptor", descending=[True, False, False, False])
    )
