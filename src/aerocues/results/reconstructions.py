"""Tables of 3D reconstructions: one row per dataset and combination."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from aerocues.results.model_quality import MODEL_QUALITY, model_quality
from aerocues.results.reconstruction_schema import RECONSTRUCTION_IDENTITY, RECONSTRUCTIONS
from aerocues.results.schema import polars_schema
from aerocues.results.table_files import (
    TableFile,
    in_columns,
    named_methods,
    read_table_file,
    refuse_twice,
)

if TYPE_CHECKING:
    import polars as pl

FIGURES = ("reprojection_error", "points_3d", "reconstruction_seconds")
OTHER_NAMES = {"reprojection_error_px": "reprojection_error"}
FAILED = "the reconstruction failed when it was made"


def reconstruction_table(figures: pl.DataFrame) -> pl.DataFrame:
    """The columns of `schema.RECONSTRUCTIONS` in a fixed order; missing ones are null."""
    import polars as pl

    schema = polars_schema(RECONSTRUCTIONS)
    missing = [pl.lit(None).alias(name) for name in schema if name not in figures.columns]
    table = figures.with_columns(missing).select(list(schema)).cast(pl.Schema(schema))
    quality = [model_quality(row) for row in table.iter_rows(named=True)]
    return table.with_columns(pl.Series(MODEL_QUALITY, quality, pl.Float64)).sort(
        RECONSTRUCTION_IDENTITY
    )


def read_reconstructions(file: Path) -> tuple[TableFile, pl.DataFrame]:
    """Read a table of reconstructions made by other programs, from CSV or Parquet.

    Parameters
    ----------
    file : path
        Columns dataset, detector, descriptor, norm, matcher, ``reprojection_error`` in pixels (or
        ``reprojection_error_px``), ``points_3d``, ``reconstruction_seconds``; optionally status and
        message. A row without any values is a failed reconstruction.

    Raises
    ------
    StoreError
        If the file cannot be read, its columns are invalid or a combination occurs twice.
    """
    import polars as pl

    table = read_table_file(file, OTHER_NAMES)
    found = in_columns(table, RECONSTRUCTIONS, (*RECONSTRUCTION_IDENTITY, *FIGURES))
    found = named_methods(table, found)
    refuse_twice(table, found, RECONSTRUCTION_IDENTITY)
    failed = pl.all_horizontal(pl.col(FIGURES).is_null())
    status = pl.when(failed).then(pl.lit("error")).otherwise(pl.lit("ok"))
    told = pl.when(failed & pl.col("status").is_null()).then(pl.lit(FAILED))
    return table, reconstruction_table(
        found.with_columns(
            pl.coalesce("message", told).alias("message"),
            pl.coalesce("status", status).alias("status"),
        )
    )
