"""`aerocues status`: how far a run has got."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from rich.table import Table

    from aerocues.evaluation.results import RunStatus

LONGEST_MESSAGE = 160
LONGEST_LIST = 40
# OpenCV puts its version and a path of the machine that built it before what it has to say.
OPENCV_PREFIX = re.compile(r"OpenCV\([^)]*\) \S+: error: ")


def status(
    folder: Annotated[Path, typer.Argument(metavar="RESULTS", help="A results folder.")],
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Show what is done, left, failed and left out, with reasons."""
    import aerocues

    found = aerocues.Results(folder).status()
    if as_json:
        _print_json(found)
    else:
        _print_status(found, folder)


def _print_json(found: RunStatus) -> None:
    import json

    facts = {
        "planned": found.planned,
        "done": found.done,
        "left": found.left,
        "statuses": dict(found.statuses),
        "failures": found.failures.to_dicts(),
        "exclusions": found.exclusions,
    }
    typer.echo(json.dumps(facts, indent=2))


def _print_status(found: RunStatus, folder: Path) -> None:
    from rich.text import Text

    from aerocues.cli.console import plain_table, print_table, standard_output

    console = standard_output()
    left = f", {found.left:,} left" if found.left else ", none left"
    console.print(Text(f"{found.done:,} of {found.planned:,} rows done{left}", style="bold"))
    by_status = plain_table("", "rows", numbers=1)
    for name, number in found.statuses.items():
        by_status.add_row(f"  {name}", f"{number:,}")
    if found.statuses:
        print_table(console, by_status)
    if len(found.failures):
        console.print(Text("\nnot ok, by reason and methods", style="bold"))
        print_table(console, _failures(found))
        if len(found.failures) > LONGEST_LIST:
            console.print(f"and {len(found.failures) - LONGEST_LIST} more; --json prints all")
    if found.exclusions:
        console.print(Text("\nleft out because of the images", style="bold"))
        for exclusion in found.exclusions:
            on = f"{exclusion['combination']} on {exclusion['pairs']:,} pairs"
            console.print(Text(f"  {on}: {exclusion['reason']}"))
    if found.left:
        console.print(Text(f"\nrun the same command again (-o {folder}) to measure what is left"))


def _failures(found: RunStatus) -> Table:
    from rich.text import Text

    from aerocues.cli.console import plain_table

    table = plain_table("status", "rows", "methods", "example")
    table.columns[1].justify = "right"
    for row in found.failures.head(LONGEST_LIST).iter_rows(named=True):
        message = OPENCV_PREFIX.sub("OpenCV: ", " ".join((row["message"] or "").split()))
        methods = f"{row['detector']}-{row['descriptor']}"
        table.add_row(row["status"], f"{row['rows']:,}", methods, Text(message[:LONGEST_MESSAGE]))
    return table
