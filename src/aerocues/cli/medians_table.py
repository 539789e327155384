"""Medians of each combination, as a table of 100 columns."""

from __future__ import annotations

from typing import TYPE_CHECKING

from aerocues.cli.console import plain_table, print_table, standard_output
from aerocues.phrases import count

if TYPE_CHECKING:
    import polars as pl

NARROW = 96
STAGES = ("detect", "describe", "match", "verify")


def print_medians(table: pl.DataFrame, top: int) -> None:
    """Print the `top` combinations with the highest inlier ratio, for each dataset."""
    for (dataset,), rows in table.group_by("dataset", maintain_order=True):
        _print_dataset(str(dataset), rows, top)


def _seconds(value: float | None) -> str:
    return "-" if value is None else f"{value:.3f}" if value < 100 else f"{value:,.0f}"


def _print_dataset(dataset: str, rows: pl.DataFrame, top: int) -> None:
    from rich.text import Text

    from aerocues.results.medians import PAIR, combination_medians

    ranked = combination_medians(rows)
    best = ranked.head(top)
    uneven = ranked["pairs"].min() != ranked["pairs"].max()
    console = standard_output()
    stages = STAGES if console.width >= NARROW else ()
    headings = ["inlier\nratio", "\nmatches", "\ninliers", "\nsuccess", "seconds\na pair"]
    headings += [f"\n{stage}" for stage in stages]
    headings += ["\npairs"] if uneven else []
    output = plain_table("\ncombination", *headings, numbers=len(headings), gap=1)
    for row in best.iter_rows(named=True):
        output.add_row(
            row["combination"],
            f"{row['precision']:.3f}",
            f"{row['matches']:,.0f}",
            f"{row['inliers']:,.0f}",
            f"{100 * row['success_rate']:.0f} %",
            _seconds(row["total_seconds"]),
            *(_seconds(row[f"{stage}_seconds"]) for stage in stages),
            *([f"{row['pairs']:,}"] if uneven else []),
        )
    shown = f"best {len(best)} of " if len(best) < len(ranked) else ""
    pairs = count(rows.select(PAIR).n_unique(), "pair")
    title = f"{dataset}: {shown}{count(len(ranked), 'combination')} on {pairs}, by inlier ratio"
    console.print(Text(title, style="bold"))
    print_table(console, output)
    note = (
        "Medians over all pairs. A failed pair counts as 0; its times count if known. "
        "'aerocues score' ranks by all criteria."
    )
    console.print(Text(note, style="dim"))
