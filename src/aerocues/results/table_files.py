"""Reads tables of other programs from CSV or Parquet into our columns, with precise errors."""

from __future__ import annotations

import hashlib
import io
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from aerocues.errors import StoreError
from aerocues.methods.combination import METHOD_NAME
from aerocues.results.combination_columns import METHODS
from aerocues.results.csv_files import CsvError, read_csv
from aerocues.results.export import DEFUSED
from aerocues.results.integrity import why_undecodable
from aerocues.results.schema import Column, polars_schema

if TYPE_CHECKING:
    import polars as pl

PARQUET_MARK = b"PAR1"
# Texts that programs write for a missing number.
NO_NUMBER = ("", "NA", "N/A", "NaN", "nan", "null", "None", "-")
MAY_BE_NEGATIVE = ("seed",)
LARGEST_WHOLE = 2**53
"""Floating-point numbers beyond do not tell neighbouring whole numbers apart."""
DECIMAL_COMMA = r"^\s*[-+]?\d+,\d+([eE][-+]?\d+)?\s*$"
DECIMAL_POINT = r"^\s*[-+]?\d*\.\d+([eE][-+]?\d+)?\s*$"
NO_THOUSANDS = r"^\s*[-+]?(0\d*|\d{4,}),\d+|^\s*[-+]?\d+,(\d{1,2}|\d{4,})([eE]|\s*$)"
"""A comma that no program writes between thousands."""


@dataclass(frozen=True)
class TableFile:
    """A file with a table: its name, the hash of its content, and its original columns."""

    name: str
    sha256: str
    frame: pl.DataFrame

    def wrong(self, what: str) -> StoreError:
        """An error that names the file."""
        return StoreError(f"{self.name} {what}")


def read_table_file(file: Path, other_names: Mapping[str, str]) -> TableFile:
    """Read a table; all columns of a CSV file are text.

    Parameters
    ----------
    file : path
    other_names : mapping of str to str
        Other names that a column may have, and our name for it.

    Raises
    ------
    StoreError
        If it cannot be read, is neither CSV nor Parquet, is damaged or has no rows.
    """
    import polars as pl

    try:
        content = file.read_bytes()
    except OSError as error:
        raise StoreError(
            f"cannot read {file}: {error.strerror or error}; give a .csv or .parquet file"
        ) from error
    is_parquet = content.startswith(PARQUET_MARK)
    if not is_parquet and file.suffix.lower() != ".csv":
        damaged = " (its content is not Parquet)" if file.suffix.lower() == ".parquet" else ""
        raise StoreError(f"{file} is neither CSV nor Parquet{damaged}; give one of these")
    frame = _parquet(content, file) if is_parquet else _csv(content, file)
    frame = frame.filter(~pl.all_horizontal(pl.all().is_null()))  # blank lines
    if frame.is_empty():
        raise StoreError(f"{file} has no rows; give a table with at least one row")
    table = TableFile(file.name, hashlib.sha256(content).hexdigest(), frame)
    names = [name.strip().lower() for name in frame.columns]
    names = [other_names.get(name, name) for name in names]
    for given, name in zip(frame.columns, names, strict=True):
        if names.count(name) > 1:
            raise table.wrong(f"has the column {name} twice (as {given}); keep one of them")
    return replace(table, frame=frame.rename(dict(zip(frame.columns, names, strict=True))))


def _csv(content: bytes, file: Path) -> pl.DataFrame:
    try:
        return read_csv(content, str(file))
    except CsvError as error:
        raise StoreError(f"{file} cannot be read as CSV: {error}") from error


def _parquet(content: bytes, file: Path) -> pl.DataFrame:
    import polars as pl

    if problem := why_undecodable(content):
        raise StoreError(f"{file} cannot be read as Parquet: {problem}; save it again")
    return pl.read_parquet(io.BytesIO(content))


def in_columns(
    table: TableFile, columns: Sequence[Column], required: Collection[str]
) -> pl.DataFrame:
    """The table with exactly these columns and types; NaN and blanks become null.

    Raises
    ------
    StoreError
        If a required column is missing, a column is unknown, or a value is invalid.
    """
    import polars as pl

    _check_names(table, columns, required)
    types = polars_schema(columns)
    table = _with_decimal_points(
        table, [column.name for column in columns if column.type != "string"]
    )
    return pl.DataFrame(
        [
            _converted(table, column)
            if column.name in table.frame.columns
            else pl.repeat(None, len(table.frame), dtype=types[column.name], eager=True).alias(
                column.name
            )
            for column in columns
        ]
    )


def _check_names(table: TableFile, columns: Sequence[Column], required: Collection[str]) -> None:
    found = table.frame.columns
    known = {column.name for column in columns}
    unknown = [name for name in found if name not in known]
    missing = [name for name in required if name not in found]
    faults = []
    if unknown:
        faults.append(f"has unknown columns: {', '.join(unknown)}")
    if missing:
        faults.append(f"lacks the columns {', '.join(missing)}")
    if faults:
        raise table.wrong(f"{' and '.join(faults)}; rename, remove or add them")


def _with_decimal_points(table: TableFile, numbers: Collection[str]) -> TableFile:
    """The table with points where it has decimal commas in columns of numbers.

    Raises
    ------
    StoreError
        If a comma could also stand between thousands.
    """
    import polars as pl

    names = [name for name in numbers if name in table.frame.columns]
    texts = [name for name in names if table.frame.schema[name] == pl.String]
    commas = table.frame.select(pl.col(texts).str.contains(DECIMAL_COMMA))
    found = [name for name in texts if commas[name].any()]
    if not found:
        return table
    row = first_row(commas[found[0]]) or 0
    where = f"has {table.frame[found[0]].item(row - 1)!r} as {found[0]} in row {row}"
    if any(table.frame[name].str.contains(DECIMAL_POINT).any() for name in texts):
        raise table.wrong(f"{where}, and numbers with points; write decimal points everywhere")
    sure = any(table.frame[name].str.contains(NO_THOUSANDS).any() for name in found)
    if not sure:
        raise table.wrong(f"{where}, which may stand for thousands; write decimal points")
    points = pl.col(found).str.replace(",", ".", literal=True)
    return replace(table, frame=table.frame.with_columns(points))


def _converted(table: TableFile, column: Column) -> pl.Series:
    import polars as pl

    values = table.frame[column.name]
    if values.dtype.is_nested() or values.dtype in (pl.Binary, pl.Object):
        raise table.wrong(
            f"has {values.dtype} values in the column {column.name}; give plain values"
        )
    if column.type == "string":
        text = values.cast(pl.String).str.strip_chars().str.replace(DEFUSED, "$1")
        return text.set(text == "", None)
    numbers = _numbers(table, values)
    if column.name not in MAY_BE_NEGATIVE:
        _refuse(table, values, numbers < 0, "is negative")
    if column.type == "float":
        return numbers
    _refuse(
        table, values, ~numbers.is_finite() | (numbers != numbers.round()), "is not a whole number"
    )
    _refuse(table, values, numbers.abs() > LARGEST_WHOLE, "is too large")
    return numbers.cast(pl.Int64)


def _numbers(table: TableFile, values: pl.Series) -> pl.Series:
    """The values as float64; null if missing."""
    import polars as pl

    if values.dtype in (pl.String, pl.Categorical, pl.Enum):
        text = values.cast(pl.String).str.strip_chars()
        given = text.set(text.is_in(NO_NUMBER), None)
        numbers = given.cast(pl.Float64, strict=False)
        _refuse(table, values, given.is_not_null() & numbers.is_null(), "is not a number")
    elif values.dtype.is_numeric() or values.dtype == pl.Null:
        numbers = values.cast(pl.Float64)
    else:
        raise table.wrong(f"has {values.dtype} values in the column {values.name}; give numbers")
    return numbers.fill_nan(None)


def _refuse(table: TableFile, values: pl.Series, wrong: pl.Series, what: str) -> None:
    """Raise an error that names the first invalid value."""
    row = first_row(wrong)
    if row is not None:
        value = values.item(row - 1)
        raise table.wrong(f"has {value!r} as {values.name} in row {row}, which {what}; correct it")


def first_row(wrong: pl.Series) -> int | None:
    """The number of the first invalid row, counted from 1 without the heading."""
    positions = wrong.arg_true()
    return int(positions.item(0)) + 1 if len(positions) else None


def named_methods(table: TableFile, rows: pl.DataFrame) -> pl.DataFrame:
    """The rows with method names in capitals; all columns that identify a row must be present.

    Raises
    ------
    StoreError
        If a row has no dataset or method, or the name of a method is not valid in a combination.
    """
    import polars as pl

    for name in ("dataset", *METHODS):
        row = first_row(rows[name].is_null())
        if row is not None:
            raise table.wrong(f"has no {name} in row {row}; add it")
    rows = rows.with_columns(pl.col(METHODS).str.to_uppercase())
    for name in METHODS:
        for method in rows[name].unique(maintain_order=True):
            if not METHOD_NAME.fullmatch(method):
                raise table.wrong(
                    f"has the {name} {method!r}; names consist of letters, digits and _: rename it"
                )
    return rows


def refuse_twice(table: TableFile, rows: pl.DataFrame, names: Sequence[str]) -> None:
    """Raise StoreError for the first two rows that describe the same measurement."""
    twice = rows.select(names).is_duplicated()
    if not twice.any():
        return
    first = rows.select(names).filter(twice).row(0)
    same = rows.select(names).with_row_index("row", 1).filter(twice)
    numbers = [row[0] for row in same.iter_rows() if row[1:] == first][:2]
    told = ", ".join(
        f"{name} {value}" for name, value in zip(names, first, strict=True) if value is not None
    )
    raise table.wrong(
        f"rows {numbers[0]} and {numbers[1]} describe the same measurement ({told}); keep one of "
        "them"
    )
