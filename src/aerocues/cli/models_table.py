"""Models as a table of 100 columns, the best first, and the reasons of failures."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from aerocues.cli.console import plain_table, print_table, standard_output
from aerocues.results.combination_columns import combination_name, name_in_row
from aerocues.results.model_quality import best_first
from aerocues.results.reconstruction_schema import BASELINE

if TYPE_CHECKING:
    import polars as pl

    from aerocues.reconstruction.models import Models

INDENT = "  "


def print_models(models: Models) -> None:
    """Print all models of a folder."""
    from rich.text import Text

    table = best_first(models.table())
    console = standard_output()
    located = table["truth"].is_not_null().any()
    headings = ["images", "points", "in 3\nimages", "track\nlength", "error\npx"]
    headings += ["in\nplace", "off\nm"] if located else []
    headings += ["features\ns", "matches\ns", "model\ns"]
    output = plain_table("combination", "status", *headings, numbers=len(headings), gap=1)
    output.columns[0].no_wrap = True
    for row in table.iter_rows(named=True):
        output.add_row(name_in_row(row), row["status"], *_figures(row, located))
    console.print(Text(_title(table), style="bold"))
    print_table(console, output)
    for line in _notes(table):
        console.print(line, soft_wrap=True, markup=False)


def _title(table: pl.DataFrame) -> str:
    """What all combinations have in common; COLMAP's default has its own."""
    others = of_combinations(table)
    first = (others if len(others) else table).row(0, named=True)
    return (
        f"{first['dataset']}: {first['images']} images, {first['pairs']} pairs "
        f"({first['pairing']}), intrinsics {first['intrinsics']}, {first['mapper']} mapper"
    )


def _figures(row: Mapping[str, Any], located: bool) -> list[str]:
    cells = [
        f"{row['registered_images'] or 0}/{row['images']}",
        _number(row["points_3d"], ",.0f"),
        _number(row["points_in_3_images"], ",.0f"),
        _number(row["mean_track_length"], ".2f"),
        _number(row["reprojection_error"], ".2f"),
    ]
    if located:
        cells += [_number(row["placed_images"], "d"), _number(row["position_rmse"], ".1f")]
    cells += [_number(row[name], ",.1f") for name in ("feature_seconds", "matching_seconds")]
    modelling = [row[name] for name in ("verification_seconds", "mapping_seconds")]
    modelling += [] if row["refinement_seconds"] is None else [row["refinement_seconds"]]
    return [*cells, _number(None if None in modelling else sum(modelling), ",.1f")]


def _number(value: float | None, form: str) -> str:
    return "-" if value is None else format(value, form)


def _notes(table: pl.DataFrame) -> list[str]:
    """COLMAP's default in comparison, why models failed, and the reference of distances."""
    lines = []
    others = of_combinations(table)
    if len(others) and "ok" not in others["status"]:
        lines.append("no combination reconstructs the flight correctly")
    if 0 < len(others) < len(table):
        lines.append(_compared(table))
    told: dict[str, list[str]] = {}
    for row in table.iter_rows(named=True):
        if row["status"] != "ok" or row["message"]:
            told.setdefault(row["message"] or row["status"], []).append(name_in_row(row))
    for message, names in told.items():
        line = f"{', '.join(names)}: {message}"
        lines += textwrap.wrap(line, 98, subsequent_indent=INDENT, break_on_hyphens=False)
    references = table["reference"].drop_nulls().unique().to_list()
    if references:
        lines.append(f"cloud distances in the table are to {references[0]}")
    return ["", *lines] if lines else []


def _compared(table: pl.DataFrame) -> str:
    """Whether any combination beats COLMAP's default."""
    best = table.row(0, named=True)
    if name_in_row(best) == str(BASELINE) and best["status"] == "ok":
        return f"no combination beats COLMAP's default ({BASELINE}): take that"
    return f"{BASELINE} is COLMAP's default: its own SIFT and matcher, and a camera that it refines"


def of_combinations(table: pl.DataFrame) -> pl.DataFrame:
    """The rows without that of COLMAP's default."""
    return table.filter(combination_name() != str(BASELINE))
