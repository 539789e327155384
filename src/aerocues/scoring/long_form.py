"""Reads a table with one row per alternative and repeat."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import polars as pl

from aerocues.errors import ScoreError
from aerocues.scoring.criteria import Criterion

ALL = "all"


def read_long_form(
    frame: pl.DataFrame,
    alternative: str,
    criteria: Sequence[Criterion],
    repeat: str | None,
    block: str | None,
) -> dict[str, Any]:
    """The fields of a `DecisionTable`; see `DecisionTable.from_frame`."""
    if not criteria:
        raise ScoreError("name at least one criterion")
    if frame.is_empty():
        raise ScoreError("the table has no row, so there is nothing to score")
    keys = {"alternative": alternative, "repeat": repeat, "block": block}
    for name in filter(None, keys.values()):
        if name not in frame.columns:
            raise ScoreError(f"there is no column {name!r}; the table has {_columns(frame)}")
        if frame[name].dtype.is_nested():
            raise ScoreError(
                f"column {name!r} has the type {frame[name].dtype}; it must have names"
            )
    labels = frame.select(
        (pl.col(name) if name else pl.lit(ALL)).cast(pl.String).alias(key)
        for key, name in keys.items()
    )
    if labels.null_count().sum_horizontal().item():
        raise ScoreError("a row has no alternative, repeat or block; fill in the missing names")
    twice = labels.filter(labels.select("alternative", "repeat").is_duplicated())
    if len(twice):
        row = twice.row(0, named=True)
        told = f" in repeat {row['repeat']!r}" if repeat else "; name the column of the repeats"
        raise ScoreError(f"alternative {row['alternative']!r} has two rows{told}")
    alternatives, rows = np.unique(labels["alternative"].to_numpy(), return_inverse=True)
    repeats, columns = _in_order(labels["repeat"])
    numbers = _numbers(frame, criteria)
    shape = (len(alternatives), len(repeats), len(criteria))
    values, failed = np.full(shape, np.nan), np.zeros(shape, dtype=np.bool_)
    values[rows, columns] = np.where(np.isfinite(numbers), numbers, np.nan)
    failed[rows, columns] = ~np.isfinite(numbers)
    return {
        "alternatives": tuple(map(str, alternatives)),
        "repeats": repeats,
        "criteria": tuple(criteria),
        "values": values,
        "failed": failed,
        "blocks": _blocks(labels, repeats, columns),
    }


def _columns(frame: pl.DataFrame) -> str:
    return ", ".join(frame.columns)


def _in_order(labels: pl.Series) -> tuple[tuple[str, ...], Any]:
    """Distinct labels in the order of appearance, and the index of each row's label."""
    distinct = labels.unique(maintain_order=True).to_list()
    position = {label: number for number, label in enumerate(distinct)}
    return tuple(distinct), np.array([position[label] for label in labels])


def _blocks(labels: pl.DataFrame, repeats: tuple[str, ...], columns: Any) -> Any:
    _names, numbers = np.unique(labels["block"].to_numpy(), return_inverse=True)
    blocks = np.zeros(len(repeats), dtype=np.int64)
    blocks[columns] = numbers
    torn = np.flatnonzero(blocks[columns] != numbers)
    if len(torn):
        raise ScoreError(
            f"repeat {repeats[columns[torn[0]]]!r} is in two blocks; each must be in one"
        )
    return blocks


def _numbers(frame: pl.DataFrame, criteria: Sequence[Criterion]) -> Any:
    """(rows, criteria) float64; NaN where a row has no value."""
    columns = []
    for criterion in criteria:
        values = values_of(frame, criterion)
        if not (values.dtype.is_numeric() or values.dtype in (pl.Boolean, pl.Null)):
            raise ScoreError(
                f"criterion {criterion.name} has the type {values.dtype}, not numbers; clean the "
                f"column {criterion.source!r}"
            )
        columns.append(values.cast(pl.Float64).fill_null(float("nan")).to_numpy())
    return np.stack(columns, axis=1)


def values_of(frame: pl.DataFrame, criterion: Criterion) -> pl.Series:
    """The values of a criterion, one per row; ScoreError if a column is missing."""
    if criterion.source in frame.columns:
        return frame[criterion.source]
    try:
        values = frame.select(pl.sql_expr(criterion.source).alias(criterion.name)).to_series()
    except pl.exceptions.PolarsError as error:
        raise ScoreError(
            f"criterion {criterion.name} needs {criterion.source!r}, which the table does not "
            f"have; its columns are {_columns(frame)}"
        ) from error
    return values if len(values) == len(frame) else pl.repeat(values[0], len(frame), eager=True)
