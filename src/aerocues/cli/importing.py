"""`aerocues import`: makes results folders from other measurement tables."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from aerocues.results.measured_results import Results


def import_table(
    file: Annotated[
        Path,
        typer.Argument(metavar="FILE", help="Measurements (.csv or .parquet), one row per pair."),
    ],
    output: Annotated[
        Path,
        typer.Option(
            "-o",
            "--output",
            metavar="RESULTS",
            help="Results folder; with several datasets or platforms, a folder of results folders.",
        ),
    ],
    reconstruction: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Figures of 3D reconstructions (.csv or .parquet)."),
    ] = None,
    dataset: Annotated[
        str | None, typer.Option(metavar="NAME", help="Import only this dataset.")
    ] = None,
    platform: Annotated[
        str | None, typer.Option(metavar="NAME", help="Import only this platform.")
    ] = None,
) -> None:
    """Make results folders from other measurement tables."""
    import aerocues
    from aerocues.cli.interruption import interruptible

    with interruptible():
        made = aerocues.import_results(
            file, output, reconstruction=reconstruction, dataset=dataset, platform=platform
        )
    _print_folders(made)


def _print_folders(made: list[Results]) -> None:
    import polars as pl

    from aerocues.cli.console import aligned
    from aerocues.results.combination_columns import METHODS

    lines = []
    for results in made:
        table = results.table()
        lines.append(
            {
                "results folder": str(results.folder),
                "rows": len(table),
                "combinations": table.select(METHODS).n_unique(),
                "pairs": table.select("image_1", "image_2").n_unique(),
                "reconstructions": len(results.reconstructions()),
            }
        )
    folders = pl.DataFrame(lines)
    if not folders["reconstructions"].sum():
        folders = folders.drop("reconstructions")
    for line in aligned(folders):
        typer.echo(line)
