"""`aerocues datasets`: lists the kinds of dataset; fetches the public ones."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from aerocues.cli.options import JsonOption

if TYPE_CHECKING:
    from rich.progress import Progress as Bars
    from rich.progress import TaskID

    from aerocues.datasets.downloading import Progress

app = typer.Typer(help="List the kinds of dataset, or fetch one.", no_args_is_help=False)


@app.callback(invoke_without_command=True)
def datasets(
    context: typer.Context,
    as_json: JsonOption = False,
) -> None:
    """List the kinds of dataset, what each needs and where to get it."""
    if context.invoked_subcommand is None:
        if as_json:
            _print_json()
        else:
            _print_table()


@app.command()
def fetch(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Dataset: oxford or hpatches.")],
    to: Annotated[Path, typer.Option("--to", metavar="DIR", help="Folder to download to.")],
    base_url: Annotated[
        str | None,
        typer.Option(metavar="URL", help="URL of a mirror with the same archives."),
    ] = None,
) -> None:
    """Download a benchmark from its authors. Continues an interrupted download."""
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        DownloadColumn,
        Progress,
        TextColumn,
        TimeRemainingColumn,
        TransferSpeedColumn,
    )

    from aerocues.datasets.fetch import fetch as fetch_benchmark

    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        DownloadColumn(),
        TransferSpeedColumn(),
        TimeRemainingColumn(),
    )
    bars = Progress(*columns, console=Console(stderr=True))
    try:
        folders = fetch_benchmark(name, to, base_url=base_url, progress=_shown_on(bars))
    finally:
        if bars.live.is_started:
            bars.stop()
    typer.echo(f"{len(folders)} sequences in {to}; measure them with: aerocues run {name}:{to}")


def _shown_on(bars: Bars) -> Progress:
    """A progress bar for each file, shown when its download starts."""
    tasks: dict[str, TaskID] = {}

    def show(file: str, done: int, total: int | None) -> None:
        if file not in tasks:
            bars.start()
            tasks[file] = bars.add_task(file, total=total)
        bars.update(tasks[file], completed=done, total=total)

    return show


def _print_table() -> None:
    from rich.text import Text

    from aerocues.cli.console import plain_table, print_table, standard_output
    from aerocues.datasets.kinds import CATALOG

    table = plain_table("", "")
    for kind in CATALOG:
        table.add_row(Text(kind.form, style="bold"), Text())
        for label, value in (
            ("pairs", kind.pairs),
            ("ground truth", kind.ground_truth),
            ("needs", kind.needs),
            ("where", kind.where),
        ):
            table.add_row(Text(f"  {label}"), Text(value))
    print_table(standard_output(), table)
    typer.echo("Layouts and terms: aerocues datasets --json")


def _print_json() -> None:
    import json
    from dataclasses import fields

    from aerocues.datasets.kinds import CATALOG

    rows = [
        {field.name: getattr(kind, field.name) for field in fields(kind) if field.name != "load"}
        for kind in CATALOG
    ]
    typer.echo(json.dumps(rows, indent=2))
