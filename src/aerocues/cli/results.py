"""`aerocues results`: gets the rows out of a results folder."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    import polars as pl

    from aerocues.evaluation.results import Results

TOP = 5
STANDARD_OUTPUT = "-"


def results(
    folder: Annotated[Path, typer.Argument(metavar="RESULTS", help="A results folder.")],
    sql: Annotated[
        str | None,
        typer.Option(metavar="QUERY", help="A query over the table 'results', not all its rows."),
    ] = None,
    csv: Annotated[
        str | None, typer.Option(metavar="FILE", help="Write CSV; - is standard output.")
    ] = None,
    parquet: Annotated[
        str | None, typer.Option(metavar="FILE", help="Write Parquet; - is standard output.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
    top: Annotated[
        int, typer.Option(min=1, metavar="N", help="Combinations in the summary.")
    ] = TOP,
) -> None:
    """Print a summary, answer a query, or write the rows to a file."""
    import aerocues

    targets = {"csv": csv, "parquet": parquet, "json": STANDARD_OUTPUT if as_json else None}
    asked = {form: target for form, target in targets.items() if target is not None}
    if len(asked) > 1:
        raise typer.BadParameter("choose one of --csv, --parquet and --json")
    found = aerocues.Results(folder)
    if not asked and sql is None:
        _print_summary(found, top)
        return
    table = found.table() if sql is None else found.sql(sql)
    if not asked:
        _print_table(table)
    for form, target in asked.items():
        _write(table, target, form)


def _write(table: pl.DataFrame, target: str, form: str) -> None:
    from aerocues.evaluation.export import export_table, table_content

    if target != STANDARD_OUTPUT:
        export_table(table, Path(target), form)
        sys.stderr.write(f"{len(table):,} rows written to {target}\n")
        return
    if form == "parquet" and sys.stdout.isatty():
        raise typer.BadParameter("Parquet is no text; name a file or redirect the output")
    sys.stdout.buffer.write(table_content(table, form))
    if form == "json":
        sys.stdout.buffer.write(b"\n")
    sys.stdout.buffer.flush()


def _print_table(table: pl.DataFrame) -> None:
    from aerocues.cli.console import aligned

    for line in aligned(table):
        typer.echo(line)


def _print_summary(found: Results, top: int) -> None:
    from rich.text import Text

    from aerocues.cli.console import count, standard_output
    from aerocues.cli.ranking import print_ranking
    from aerocues.evaluation.schema import COLUMNS

    table, settings = found.table(), found.settings
    console = standard_output()
    if table.is_empty():
        console.print("there are no rows yet")
    print_ranking(table, top)
    versions = settings.get("versions", {})
    combinations = table.select("detector", "descriptor", "norm", "matcher").n_unique()
    rows = f"{count(len(table), 'row')} of {count(combinations, 'combination')}"
    made = f"preset {settings.get('preset')}, OpenCV {versions.get('opencv')}"
    console.print(Text(f"\n{rows}; {made}\n{settings.get('machine', {}).get('name')}"))
    console.print(Text("\ncolumns", style="bold"))
    console.print(Text(", ".join(column.name for column in COLUMNS)))
    console.print("\nget them out with --csv FILE, --parquet FILE, --json or --sql QUERY")
