"""Rows measured by other programs, completed with derived columns."""

from __future__ import annotations

from typing import TYPE_CHECKING

from aerocues.results.combination_columns import METHODS
from aerocues.results.plan_table import IDENTITY_NAMES
from aerocues.results.schema import COLUMNS
from aerocues.results.statuses import STATUSES
from aerocues.results.table_files import (
    TableFile,
    first_row,
    in_columns,
    named_methods,
    refuse_twice,
)

if TYPE_CHECKING:
    import polars as pl

IMPORTED = "imported"
OTHER_NAMES = {"platform": "machine"}
VALUES = (
    "precision",
    "recall",
    "repeatability",
    "f1_score",
    "inliers",
    "matches",
    "seconds_per_1k_matches",
    "seconds_per_1k_inliers",
)
REQUIRED = ("dataset", *METHODS, "pair", *VALUES)
RATIOS = ("precision", "recall", "repeatability", "f1_score")
FAILED = "it failed when it was measured"


def completed_rows(table: TableFile) -> pl.DataFrame:
    """The rows of a table in the columns of `schema.COLUMNS`.

    A row without any of the required values gets the status ``error``, unless it has another
    status. Images without a name are named after the number of the pair.

    Raises
    ------
    StoreError
        If columns are missing or unknown, a value is invalid or a row occurs twice.
    """
    rows = named_methods(table, in_columns(table, COLUMNS, REQUIRED))
    _check_values(table, rows)
    rows = _completed(rows)
    refuse_twice(table, rows, ("machine", *IDENTITY_NAMES))
    return rows


def _check_values(table: TableFile, rows: pl.DataFrame) -> None:
    import polars as pl

    known = [status.name for status in STATUSES]
    checks = (
        (pl.col("pair").is_null(), "has no pair number"),
        *(
            (pl.col(name) > 1, f"has a {name} above 1; it must be a ratio, not percent")
            for name in RATIOS
        ),
        *(
            (pl.col(name).is_infinite(), f"has an infinite {name}; leave it empty")
            for name in VALUES
            if rows.schema[name].is_float()
        ),
        (pl.col("inliers") > pl.col("matches"), "has more inliers than matches"),
        (
            ~pl.col("status").is_in(known),
            f"has an unknown status; choose from: {', '.join(known)}",
        ),
    )
    for wrong, what in checks:
        row = first_row(rows.select(wrong.alias("wrong"))["wrong"])
        if row is not None:
            raise table.wrong(f"row {row} {what}; correct it")


def _completed(rows: pl.DataFrame) -> pl.DataFrame:
    import polars as pl

    failed = pl.all_horizontal(pl.col(VALUES).is_null())
    untold = failed & pl.col("status").is_null()
    total = pl.col("seconds_per_1k_matches") * pl.col("matches") / 1000
    images = (
        pl.coalesce(f"image_{k}", pl.format("pair {}, image {}", "pair", pl.lit(k))).alias(
            f"image_{k}"
        )
        for k in (1, 2)
    )
    return rows.with_columns(
        pl.coalesce("message", pl.when(untold).then(pl.lit(FAILED))).alias("message"),
        pl.coalesce("status", pl.when(failed).then(pl.lit("error")).otherwise(pl.lit("ok"))).alias(
            "status"
        ),
        pl.coalesce("total_seconds", total).alias("total_seconds"),
        pl.coalesce("preset", pl.lit(IMPORTED)).alias("preset"),
        *images,
    )
