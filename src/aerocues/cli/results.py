"""`aerocues results`: exports the rows of a results folder."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from aerocues.cli.options import JsonOption, ResultsArgument
from aerocues.cli.output import STANDARD_OUTPUT, write_table
from aerocues.results.combination_columns import METHODS

if TYPE_CHECKING:
    import polars as pl

    from aerocues.results.measured_results import Results

TOP = 5


def results(
    folder: ResultsArgument,
    sql: Annotated[
        str | None,
        typer.Option(metavar="QUERY", help="SQL query over the table 'results'."),
    ] = None,
    csv: Annotated[
        str | None, typer.Option(metavar="FILE", help="Write CSV; - is standard output.")
    ] = None,
    parquet: Annotated[
        str | None, typer.Option(metavar="FILE", help="Write Parquet; - is standard output.")
    ] = None,
    markdown: Annotated[
        str | None, typer.Option(metavar="FILE", help="Write a Markdown table of rounded values.")
    ] = None,
    latex: Annotated[
        str | None, typer.Option(metavar="FILE", help="Write a LaTeX table of rounded values.")
    ] = None,
    as_json: JsonOption = False,
    columns: Annotated[
        bool, typer.Option("--columns", help="List the columns with their meaning.")
    ] = False,
    pack: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Pack the whole folder into one zip file."),
    ] = None,
    top: Annotated[
        int, typer.Option(min=1, metavar="N", help="Number of combinations in the summary.")
    ] = TOP,
) -> None:
    """Print a summary, answer a query, or write the rows to a file."""
    import aerocues

    targets = {"csv": csv, "parquet": parquet, "markdown": markdown, "latex": latex}
    targets["json"] = STANDARD_OUTPUT if as_json else None
    asked = {form: target for form, target in targets.items() if target is not None}
    if len(asked) > 1:
        raise typer.BadParameter(f"choose one of {', '.join(f'--{form}' for form in targets)}")
    if columns and (asked or sql is not None or pack):
        raise typer.BadParameter("--columns cannot be combined with other options")
    if pack and (asked or sql is not None):
        raise typer.BadParameter(
            "--pack cannot be combined with other options: it packs the whole folder"
        )
    found = aerocues.Results(folder)
    if pack:
        _pack(found, pack)
        return
    if columns:
        _print_columns()
        return
    if not asked and sql is None:
        _print_summary(found, top)
        return
    table = found.table() if sql is None else found.sql(sql)
    if not asked:
        _print_table(table)
    for form, target in asked.items():
        write_table(table, target, form)


def _pack(found: Results, target: Path) -> None:
    from aerocues.phrases import count

    if str(target) == STANDARD_OUTPUT:
        raise typer.BadParameter("a packed folder needs the name of a file, such as results.zip")
    file = found.pack(target)
    size = f"{file.stat().st_size / 1e3:,.0f} kB"
    sys.stderr.write(f"{count(len(found.table()), 'row')} packed into {file} ({size})\n")


def _print_table(table: pl.DataFrame) -> None:
    from aerocues.cli.console import aligned

    for line in aligned(table):
        typer.echo(line)


def _print_columns() -> None:
    from rich.text import Text

    from aerocues.cli.console import plain_table, print_table, standard_output
    from aerocues.results.schema import COLUMNS

    table = plain_table("column", "unit", "definition")
    for column in COLUMNS:
        table.add_row(Text(column.name), Text(column.unit), Text(column.definition))
    table.columns[0].no_wrap = True
    print_table(standard_output(), table)


def _print_summary(found: Results, top: int) -> None:
    from rich.text import Text

    from aerocues.cli.console import standard_output
    from aerocues.cli.medians_table import print_medians
    from aerocues.phrases import count

    table, settings = found.table(), found.settings
    console = standard_output()
    if table.is_empty():
        console.print("there are no rows yet")
    print_medians(table, top)
    combinations = table.select(METHODS).n_unique()
    rows = f"{count(len(table), 'row')} of {count(combinations, 'combination')}"
    console.print(Text(f"\n{rows}; {_origin(settings)}"))
    for machine in table["machine"].drop_nulls().unique().sort():
        console.print(Text(machine))
    if models := len(found.reconstructions()):
        console.print(Text(f"{count(models, 'reconstruction')}, in the table reconstructions"))
    console.print(
        "\nget them out with --csv FILE, --parquet FILE, --json or --sql QUERY; "
        "--columns lists the columns",
        soft_wrap=True,
    )


def _origin(settings: dict[str, Any]) -> str:
    imported = settings.get("imported")
    if imported:
        return f"imported from {imported.get('file')}"
    version = settings.get("versions", {}).get("opencv")
    return f"preset {settings.get('preset')}, OpenCV {version}"
