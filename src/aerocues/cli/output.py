"""Tables to files or standard output, facts as JSON."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

if TYPE_CHECKING:
    import polars as pl

STANDARD_OUTPUT = "-"


def write_table(table: pl.DataFrame, target: str, form: str, what: str = "row") -> None:
    """Write a table to a file, or to standard output where that is called ``-``."""
    from aerocues.phrases import count
    from aerocues.results.export import export_table, table_content

    if target != STANDARD_OUTPUT:
        export_table(table, Path(target), form)
        sys.stderr.write(f"{count(len(table), what)} written to {target}\n")
        return
    if form == "parquet" and sys.stdout.isatty():
        raise typer.BadParameter("Parquet is no text; name a file or redirect the output")
    sys.stdout.buffer.write(table_content(table, form))
    if form == "json":
        sys.stdout.buffer.write(b"\n")
    sys.stdout.buffer.flush()


def write_tables(tables: Mapping[str, pl.DataFrame], target: str, form: str) -> None:
    """Write titled tables to a file, or to standard output where that is called ``-``."""
    from aerocues.phrases import count
    from aerocues.results.export import tables_content, write_file

    content = tables_content(tables, form)
    if target == STANDARD_OUTPUT:
        sys.stdout.buffer.write(content)
        sys.stdout.buffer.flush()
        return
    write_file(Path(target), content)
    sys.stderr.write(f"{count(len(tables), 'table')} written to {target}\n")


def print_json(facts: Any) -> None:
    """Print JSON; a number that is none or infinite is null, for JSON knows neither."""
    typer.echo(json.dumps(_finite(facts), indent=2, allow_nan=False))


def _finite(facts: Any) -> Any:
    if isinstance(facts, dict):
        return {name: _finite(value) for name, value in facts.items()}
    if isinstance(facts, (list, tuple)):
        return [_finite(value) for value in facts]
    if isinstance(facts, float) and not math.isfinite(facts):
        return None
    return facts
