"""Models as a table of 100 columns, the best first, and the reasons of failures."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from aerocues.cli.console import plain_table, print_table, standard_output
from aerocues.results.combination_columns import METHODS, name_in_row

if TYPE_CHECKING:
    import polars as pl

    from aerocues.reconstruction.models import Models

INDENT = "  "


def ordered(table: pl.DataFrame) -> pl.DataFrame:
    """Successful models first, then by images, then by points.

    Not by reprojection error: broken models have the lowest.
    """
    import polars as pl

    return table.sort(
        pl.col("status") != "ok",
        -pl.col("registered_images").fill_null(0),
        -pl.col("points_3d").fill_null(0),
        *METHODS,
    )


def print_models(models: Models) -> None:
    """Print all models of a folder."""
    from rich.text import Text

    table = ordered(models.table())
    console = standard_output()
    located = table["position_rmse"].is_not_null().any()
    headings = ["images", "points", "track\nlength", "error\npx"]
    headings += ["in\nplace", "off\nm"] if located else []
    headings += ["features\ns", "matches\ns", "model\ns"]
    output = plain_table("combination", "status", *headings, numbers=len(headings), gap=1)
    output.columns[0].no_wrap = True
    for row in table.iter_rows(named=True):
        output.add_row(name_in_row(row), row["status"], *_figures(row, located))
    first = table.row(0, named=True)
    title = (
        f"{first['dataset']}: {first['images']} images, {first['pairs']} pairs "
        f"({first['pairing']}), intrinsics {first['intrinsics']}, {first['mapper']} mapper"
    )
    console.print(Text(title, style="bold"))
    print_table(console, output)
    for line in _notes(table):
        console.print(line, soft_wrap=True, markup=False)


def _figures(row: Mapping[str, Any], located: bool) -> list[str]:
    cells = [
        f"{row['registered_images'] or 0}/{row['images']}",
        _number(row["points_3d"], ",.0f"),
        _number(row["mean_track_length"], ".2f"),
        _number(row["reprojection_error"], ".2f"),
    ]
    if located:
        cells += [_number(row["placed_images"], "d"), _number(row["position_rmse"], ".1f")]
    cells += [_number(row[name], ",.1f") for name in ("feature_seconds", "matching_seconds")]
    modelling = [row[name] for name in ("verification_seconds", "mapping_seconds")]
    return [*cells, _number(None if None in modelling else sum(modelling), ",.1f")]


def _number(value: float | None, form: str) -> str:
    return "-" if value is None else format(value, form)


def _notes(table: pl.DataFrame) -> list[str]:
    """Why models failed or are incomplete, and the reference of distances."""
    import polars as pl

    lines = []
    if table["status"].is_in(["ok"]).sum() == 0:
        lines.append("no combination reconstructs the flight correctly")
    told = table.filter((pl.col("status") != "ok") | pl.col("message").is_not_null())
    for row in told.iter_rows(named=True):
        name = name_in_row(row)
        line = f"{name}: {row['message'] or row['status']}"
        lines += textwrap.wrap(line, 98, subsequent_indent=INDENT)
    references = table["reference"].drop_nulls().unique().to_list()
    if references:
        lines.append(f"cloud distances in the table are to {references[0]}")
    return ["", *lines] if lines else []
