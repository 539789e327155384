"""What `aerocues compare` prints of several datasets together, and of two machines by scores."""

from __future__ import annotations

from typing import TYPE_CHECKING

from aerocues.cli.console import plain_table, print_table
from aerocues.cli.validation_tables import LISTED, numbered_matrix, print_title
from aerocues.phrases import count, number_text
from aerocues.scoring.leaders import SHARE, TOP

if TYPE_CHECKING:
    import polars as pl
    from rich.console import Console
    from rich.table import Table

    from aerocues.scoring.compared import Runs
    from aerocues.scoring.overview import Overview
    from aerocues.scoring.platform_scores import PlatformScores

PAIRS = "detector-descriptor pairs"


def print_overview(console: Console, found: Overview, top: int) -> None:
    """Print what the datasets say together."""
    sets = count(len(found.datasets), "dataset")
    print_title(
        console,
        f"\nbest of each dataset: mean {found.mean_of_bests:.4f}, range {found.range_of_bests:.4f}",
    )
    print_table(console, _best(found))
    console.print(
        f"{found.evaluations:,} scores of combinations on {sets}; mean rank correlation of two "
        f"datasets {number_text(found.mean_correlation, 3)}"
    )
    print_title(console, f"\nthe first {TOP} of a dataset (row) that are there on another, too")
    print_table(console, counts_matrix(found))
    good = found.consistent
    print_title(
        console,
        f"\namong the best {100 * SHARE:.0f} % of every dataset: {count(len(good), 'combination')}",
    )
    if len(good):
        print_table(console, _consistent(good.head(top)))
    for component in LISTED:
        if component in found.hierarchies:
            _print_hierarchy(console, component, found.hierarchies[component], sets, top)
    for title, each in (("power alpha", found.alpha), ("aggregation", found.aggregation)):
        print_title(console, f"\n{title}: Spearman's correlation, mean over {sets}")
        print_table(console, numbered_matrix(each.names, each.correlation, digits=4))


def _best(found: Overview) -> Table:
    output = plain_table("dataset", "the best", "CUES", "scored", "elsewhere", numbers=4)
    output.columns[0].no_wrap, output.columns[1].justify = True, "left"
    for row in found.best.iter_rows(named=True):
        elsewhere = row["mean_elsewhere"]
        output.add_row(
            row["dataset"],
            row["best"],
            f"{row['score']:.4f}",
            f"{row['scored']:,}",
            "-" if elsewhere is None else f"{elsewhere:.3f}",
        )
    return output


def counts_matrix(found: Overview) -> Table:
    """Counts with the names of the datasets before the rows, and numbers above the columns."""
    numbers = [str(number + 1) for number in range(len(found.datasets))]
    output = plain_table("", "", *numbers, numbers=len(numbers), gap=1)
    output.columns[1].no_wrap = True
    for number, name, row in zip(numbers, found.datasets, found.kept, strict=True):
        output.add_row(number, name, *map(str, row))
    return output


def _consistent(frame: pl.DataFrame) -> Table:
    output = plain_table("combination", "mean", "min", "variation", "worst rank", numbers=4)
    output.columns[0].no_wrap = True
    for row in frame.iter_rows(named=True):
        output.add_row(
            row["alternative"],
            *(f"{row[name]:.3f}" for name in ("mean", "min", "variation")),
            f"{row['worst_rank']:.0f}",
        )
    return output


def _print_hierarchy(
    console: Console, component: str, frame: pl.DataFrame, sets: str, top: int
) -> None:
    shown = frame.head(top) if component == PAIRS else frame
    more = f": best {len(shown)} of {len(frame)}" if len(shown) < len(frame) else ""
    print_title(console, f"\n{component} by mean CUES over {sets}{more}")
    headings = ("mean", "max", "std", "evaluations", "the best", "on")
    output = plain_table("", *headings, numbers=len(headings), gap=1)
    output.columns[0].no_wrap = True
    output.columns[-2].justify = output.columns[-1].justify = "left"
    for row in shown.iter_rows(named=True):
        output.add_row(
            row["name"],
            *(f"{row[name]:.4f}" for name in ("mean", "max", "standard_deviation")),
            f"{row['evaluations']:,}",
            row["best"],
            row["dataset"],
        )
    print_table(console, output)


def print_machines(console: Console, runs: Runs, found: PlatformScores, top: int) -> None:
    """Print what changes from one machine to the other where each is normalised by itself."""
    print_title(console, "\nscores of each machine, normalised by itself: second minus first")
    console.print(
        f"{count(len(found.combinations), 'combination')} on {runs.first.machine} (first) and "
        f"{runs.second.machine} (second): rank correlation {number_text(found.spearman, 4)};\n"
        f"{found.kept} of the first {TOP} stay among them; largest difference {found.largest:.4f}",
        markup=False,
    )
    output = plain_table("combination", "first", "second", "difference", "rank", "then", numbers=5)
    output.columns[0].no_wrap = True
    for row in found.combinations.head(top).iter_rows(named=True):
        output.add_row(
            row["combination"],
            *(f"{row[name]:.4f}" for name in ("first_score", "second_score")),
            f"{row['difference']:+.4f}",
            *(f"{row[name]:.0f}" for name in ("first_rank", "second_rank")),
        )
    print_table(console, output)
    for component in LISTED:
        if component in found.components and component != PAIRS:
            print_title(console, f"\n{component}, mean CUES on each machine")
            print_table(console, _methods(found.components[component]))


def _methods(frame: pl.DataFrame) -> Table:
    output = plain_table("", "first", "second", "difference", "combinations", numbers=4)
    output.columns[0].no_wrap = True
    for row in frame.iter_rows(named=True):
        output.add_row(
            row["name"],
            *(f"{row[name]:.4f}" for name in ("first_mean", "second_mean")),
            f"{row['difference']:+.4f}",
            f"{row['combinations']:,}",
        )
    return output
