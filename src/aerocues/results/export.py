"""Tables as files: CSV, Parquet, JSON, Markdown and LaTeX."""

from __future__ import annotations

import io
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

from aerocues.errors import StoreError
from aerocues.results.typesetting import (
    as_latex,
    as_markdown,
    tables_as_latex,
    tables_as_markdown,
    tables_in_long_form,
)
from aerocues.results.whole_files import put_in_place

if TYPE_CHECKING:
    import polars as pl

WRITERS: dict[str, Callable[[pl.DataFrame, BinaryIO], object]] = {
    "csv": lambda table, file: defused(table).write_csv(file),
    "parquet": lambda table, file: table.write_parquet(file),
    "json": lambda table, file: file.write(table.write_json().encode()),
    "markdown": lambda table, file: file.write(as_markdown(table).encode()),
    "latex": lambda table, file: file.write(as_latex(table).encode()),
}
# Apostrophes that are there already get another one, so that each text comes back as it was.
FORMULA = r"^('*[=+\-@\t\r])"
DEFUSED = r"^'('*[=+\-@\t\r])"
# These formats can also hold lists and other nested values.
FORMS_OF_ANYTHING = ("parquet", "json")


def defused(table: pl.DataFrame) -> pl.DataFrame:
    """The table with an apostrophe before texts that a spreadsheet would take for a formula.

    Names of images and messages may come from anybody. `import_results` takes it away again.
    """
    import polars as pl

    return table.with_columns(pl.col(pl.String).str.replace(FORMULA, "'$1"))


def table_content(table: pl.DataFrame, form: str) -> memoryview:
    """A table as the content of a file; StoreError if the format cannot hold it."""
    import polars as pl

    content = io.BytesIO()
    try:
        WRITERS[form](table, content)
    except pl.exceptions.PolarsError as error:
        others = " or ".join(f"--{name}" for name in FORMS_OF_ANYTHING if name != form)
        reason = " ".join(str(error).split())
        raise StoreError(
            f"this table cannot be written as {form.upper()}: {reason}; use {others}"
        ) from error
    return content.getbuffer()


def tables_content(tables: Mapping[str, pl.DataFrame], form: str) -> bytes | memoryview:
    """Several titled tables as the content of a file, as CSV in long form."""
    if form == "csv":
        return table_content(tables_in_long_form(tables), form)
    texts = {"markdown": tables_as_markdown, "latex": tables_as_latex}
    return texts[form](tables).encode()


def export_table(table: pl.DataFrame, target: Path, form: str) -> None:
    """Write a table to a file. An existing file is replaced atomically.

    Parameters
    ----------
    table : pl.DataFrame
    target : path
        A file, or a device or pipe.
    form : {"csv", "parquet", "json", "markdown", "latex"}
        The last two are for reading: numbers are rounded to four digits.

    Raises
    ------
    StoreError
        If the file cannot be written, or the format cannot hold the table.
    """
    # Not directly to the file, because polars has its own errors for a full disk.
    write_file(target, table_content(table, form))


def write_file(target: Path, content: bytes | memoryview) -> None:
    """Write a file atomically, or write to a device or pipe; StoreError if that fails."""
    path = target.expanduser().resolve()  # a link stays a link
    is_special = path.exists() and not path.is_file() and not path.is_dir()
    beside = path if is_special else path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        if path.is_dir():
            raise IsADirectoryError(None, "it is a folder")
        with beside.open("wb") as file:
            file.write(content)
        if not is_special:
            put_in_place(beside, path)
    except OSError as error:
        raise StoreError(
            f"cannot write {target}: {error.strerror or error}; give another file"
        ) from error
    finally:
        if not is_special:
            beside.unlink(missing_ok=True)
