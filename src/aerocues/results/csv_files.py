"""CSV as programs and spreadsheets write it: other separators, encodings and ends of lines."""

from __future__ import annotations

import csv
import io
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from aerocues.errors import DamageWarning
from aerocues.text_files import decoded

if TYPE_CHECKING:
    import polars as pl

SEPARATORS = ",;\t|"
SEPARATOR_LINE = "sep="
"""Excel takes the separator from a first line ``sep=;``."""
SPREADSHEETS = (b"PK\x03\x04", b"\xd0\xcf\x11\xe0")
"""How the files of spreadsheets begin, whatever their names are."""


class CsvError(ValueError):
    """A file is not a table in CSV; the message follows "cannot be read as CSV:"."""


@dataclass(frozen=True)
class _Row:
    """The fields of a row and its place: numbers of the row below the heading, and of the line."""

    number: int
    line: int
    fields: list[str]

    def __str__(self) -> str:
        return f"row {self.number} (line {self.line})"


def read_csv(content: bytes, name: str) -> pl.DataFrame:
    """A table with one text column for each named column; empty fields are null.

    Parameters
    ----------
    content : bytes
    name : str
        What the file is called in a warning.

    Raises
    ------
    CsvError
        If a row has fewer or more fields than the heading, or the file is not CSV.
    """
    import polars as pl

    if content.startswith(SPREADSHEETS):
        raise CsvError("it is the file of a spreadsheet; save the table as CSV")
    try:
        text = decoded(content)
    except ValueError as error:
        raise CsvError(str(error)) from error
    rows = _rows(text)
    heading = next(rows, None)
    if heading is None:
        raise CsvError("it has no heading; give a table with the names of the columns")
    names = [field.strip() for field in heading.fields]
    fields = [_whole(row, len(names)) for row in rows]
    if fields and not text.endswith(("\n", "\r")):
        warnings.warn(
            f"the last line of {name} has no end; check that row {len(fields)} is whole",
            DamageWarning,
            stacklevel=2,
        )
    columns = [list(column) for column in zip(*fields, strict=True)] or [[] for _ in names]
    kept = [place for place in range(len(names)) if not _is_index(place, names, columns)]
    twice = [names[place] for place in kept if names.count(names[place]) > 1]
    if twice:
        raise CsvError(f"it has the column {twice[0] or 'without a name'} twice; keep one of them")
    values = {names[place]: [text or None for text in columns[place]] for place in kept}
    return pl.DataFrame(values, schema=dict.fromkeys(values, pl.String))


def _rows(text: str) -> Iterator[_Row]:
    """The heading and the rows; without blank lines, and comments above the heading."""
    lines = io.StringIO(text, newline="")
    skipped, separator = 0, None
    while line := _line(lines):
        words = line.strip().strip('"')
        if words.lower().startswith(SEPARATOR_LINE) and len(words) == len(SEPARATOR_LINE) + 1:
            separator = words[-1]
        elif words and not words.startswith("#"):
            break
        skipped += 1
    reader = csv.reader(
        io.StringIO(line + lines.read(), newline=""),
        delimiter=separator or _separator(line),
        strict=True,
    )
    try:
        filled = (fields for fields in reader if any(field.strip() for field in fields))
        for number, fields in enumerate(filled):
            yield _Row(number, skipped + reader.line_num, fields)
    except csv.Error as error:
        raise CsvError(f"line {skipped + reader.line_num}: {error}") from error


def _line(lines: io.StringIO) -> str:
    r"""The next line; \n, \r\n and \r end it."""
    start = lines.tell()
    line = lines.readline()
    first, end, _ = line.partition("\r")
    if not end or line == f"{first}\r\n":
        return line
    lines.seek(start + len(first) + 1)
    return f"{first}\r"


def _separator(heading: str) -> str:
    """The separator that divides the heading into most fields."""

    def fields(separator: str) -> int:
        return len(next(csv.reader([heading], delimiter=separator)))

    return max(SEPARATORS, key=fields)


def _whole(row: _Row, count: int) -> list[str]:
    """The fields of a row, as many as there are columns; empty ones at the end may be more."""
    fields = row.fields
    if len(fields) < count:
        raise CsvError(
            f"{row} has {len(fields)} fields in place of {count}, it may have been cut off; "
            "complete it or remove it"
        )
    if any(fields[count:]):
        raise CsvError(
            f"{row} has {len(fields)} fields in place of {count}; put texts with separators into "
            "double quotes"
        )
    return fields[:count]


def _is_index(place: int, names: list[str], columns: list[list[str]]) -> bool:
    """Whether a column has no name and either no values, or counts the rows at their beginning."""
    if names[place]:
        return False
    values = columns[place]
    if not any(values):
        return True
    starts = (range(first, first + len(values)) for first in (0, 1))
    if place == 0 and any(values == [str(number) for number in counted] for counted in starts):
        return True
    raise CsvError(f"column {place + 1} has no name; name it or remove it")
