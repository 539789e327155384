"""`aerocues study`: opens the database of the study, or another one, and answers queries."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from aerocues.cli.options import JsonOption
from aerocues.cli.output import STANDARD_OUTPUT, write_table
from aerocues.phrases import count

if TYPE_CHECKING:
    from aerocues.results.study import Study


def study(
    place: Annotated[
        str | None,
        typer.Argument(
            metavar="PLACE",
            help="Folder, zip file or web address of a study; by default AEROCUES_STUDY, or "
            "study/database of the checkout.",
        ),
    ] = None,
    sql: Annotated[
        str | None,
        typer.Option(
            metavar="QUERY", help="SQL over the tables 'parts', 'results' and 'reconstructions'."
        ),
    ] = None,
    csv: Annotated[
        str | None, typer.Option(metavar="FILE", help="Write CSV; - is standard output.")
    ] = None,
    as_json: JsonOption = False,
    columns: Annotated[
        bool, typer.Option("--columns", help="List the columns of the tables with their meaning.")
    ] = False,
    pack: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Pack all parts into one zip file.")
    ] = None,
) -> None:
    """Show what is in a study, or answer a query over its parts.

    Where another command takes results, study:PART is that part of the study.
    """
    import aerocues

    if csv is not None and as_json:
        raise typer.BadParameter("choose one of --csv and --json")
    shown = sql is not None or csv is not None or as_json
    if columns + (pack is not None) + shown > 1:
        raise typer.BadParameter("choose one of --columns, --pack and --sql (or --csv, --json)")
    if columns:
        _print_columns()
        return
    found = aerocues.Study(place)
    if pack is not None:
        file = found.pack(pack)
        size = f"{file.stat().st_size / 1e6:,.1f} MB"
        sys.stderr.write(f"{count(len(found.names), 'part')} packed into {file} ({size})\n")
        return
    target = STANDARD_OUTPUT if as_json else csv
    if sql is None and target is None:
        _print_parts(found)
        return
    table = found.parts() if sql is None else found.sql(sql)
    if target is not None:
        write_table(table, target, "json" if as_json else "csv")
        return
    from aerocues.cli.console import aligned

    for line in aligned(table):
        typer.echo(line)


def _print_parts(found: Study) -> None:
    from rich.text import Text

    from aerocues.cli.console import plain_table, print_table, standard_output

    parts = found.parts()
    numbers = ("combinations", "pairs", "rows", "ok", "models")
    table = plain_table("part", "preset", *numbers, numbers=len(numbers))
    for row in parts.iter_rows(named=True):
        table.add_row(
            Text(row["part"]), Text(row["preset"] or ""), *(f"{row[name]:,}" for name in numbers)
        )
    console = standard_output()
    print_table(console, table)
    hours = parts["cpu_hours"].sum()
    lines = [
        "",
        f"{parts['rows'].sum():,} rows and {parts['models'].sum():,} models, {hours:.1f} CPU hours",
        *(
            f"{label:8s}  {', '.join(parts[name].drop_nulls().unique().sort())}"
            for label, name in (("aerocues", "aerocues"), ("OpenCV", "opencv"))
        ),
        *parts["machine"].drop_nulls().unique().sort(),
        "",
        f"next      aerocues score study:{found.names[0]}",
        "          aerocues study --sql 'SELECT part, title, licence FROM parts'",
        "          aerocues study --columns",
    ]
    for line in lines:
        console.print(line, soft_wrap=True, markup=False)


def _print_columns() -> None:
    from aerocues.results.study_dictionary import dictionary

    for table, columns in dictionary().items():
        typer.echo(f"{table}")
        for column in columns:
            unit = f" [{column.unit}]" if column.unit else ""
            typer.echo(f"  {column.name}{unit}: {column.definition}")
