"""`aerocues compare`: rankings across data sets and machines."""

from __future__ import annotations

import json
import sys
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from aerocues.cli.scoring import (
    AlphaOption,
    CriteriaOption,
    FailuresOption,
    PresetOption,
)

if TYPE_CHECKING:
    import polars as pl
    from rich.console import Console

    from aerocues.scoring.across import Entry, Machines
    from aerocues.scoring.comparison import Comparison


LISTED = 6


class Over(StrEnum):
    """Values of ``--over``."""

    PAIRWISE = "pairwise"
    ALL = "all"


def compare(
    folders: Annotated[
        list[Path], typer.Argument(metavar="RESULTS...", help="Results folders or packed ones.")
    ],
    preset: PresetOption = None,
    criteria: CriteriaOption = None,
    failures: FailuresOption = None,
    alpha: AlphaOption = None,
    reconstruction: Annotated[
        bool, typer.Option("--reconstruction", help="Score the 3D models, too, in all results.")
    ] = False,
    over: Annotated[
        Over, typer.Option(help="Combinations scored in both of two results, or in all.")
    ] = Over.PAIRWISE,
    top: Annotated[int, typer.Option(min=1, metavar="N", help="Length of the table.")] = 15,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
    csv: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write the scores of all as CSV.")
    ] = None,
) -> None:
    """Compare rankings across data sets, and times across machines."""
    import aerocues
    from aerocues.cli.interruption import interruptible
    from aerocues.cli.scoring import named
    from aerocues.scoring.across import compare_datasets, compare_machines, entries_of

    with interruptible():
        entries = entries_of(
            [aerocues.Results(folder) for folder in folders],
            preset,
            criteria=named(criteria),
            reconstruction=reconstruction,
            failures=failures.value if failures else None,
            alpha=alpha,
        )
        comparison = compare_datasets(entries, over.value)
        machines = compare_machines(entries, over.value)
    if csv is not None:
        _write(comparison, csv)
    if as_json:
        typer.echo(json.dumps(_facts(entries, comparison, machines), indent=2))
    else:
        _print(entries, comparison, machines, top)


def _write(comparison: Comparison, target: Path) -> None:
    from aerocues.evaluation.export import export_table

    frame = comparison.versatility().rename({"alternative": "combination"})
    export_table(frame, target, "csv")
    sys.stderr.write(f"{len(frame):,} combinations written to {target}\n")


def _facts(
    entries: list[Entry], comparison: Comparison, machines: list[Machines]
) -> dict[str, Any]:
    from aerocues.cli.validate import matrix_facts

    return {
        "results": [
            {"name": each.name, "dataset": each.dataset, "machine": each.machine}
            for each in entries
        ],
        "preset": entries[0].preset,
        "over": comparison.over,
        "spearman": matrix_facts(comparison.names, comparison.spearman()),
        "kendall": matrix_facts(comparison.names, comparison.kendall()),
        "shared": comparison.shared().tolist(),
        "versatility": comparison.versatility().rename({"alternative": "combination"}).to_dicts(),
        "machines": [
            {
                "first": each.first.name,
                "second": each.second.name,
                "spearman": matrix_facts(each.rankings.names, each.rankings.spearman()),
                "times": each.times if isinstance(each.times, str) else each.times.to_dicts(),
            }
            for each in machines
        ],
    }


def _print(
    entries: list[Entry], comparison: Comparison, machines: list[Machines], top: int
) -> None:
    from aerocues.cli.console import count, print_table, standard_output
    from aerocues.cli.validation_tables import numbered_matrix, print_title

    console = standard_output()
    told = {
        "pairwise": "over the combinations scored in both",
        "all": "over the combinations scored in all",
    }[comparison.over]
    print_title(console, f"{count(len(entries), 'ranking')}, preset {entries[0].preset}")
    for name, values in (("Spearman", comparison.spearman()), ("Kendall", comparison.kendall())):
        print_title(console, f"\n{name}'s rank correlation, {told}")
        print_table(console, numbered_matrix(comparison.names, values))
    _print_versatility(console, comparison, top)
    for each in machines:
        _print_machines(console, each)


def _print_versatility(console: Console, comparison: Comparison, top: int) -> None:
    from aerocues.cli.console import plain_table, print_table
    from aerocues.cli.validation_tables import print_title

    frame = comparison.versatility()
    shown = frame.head(top)
    print_title(console, f"\nversatility: best {len(shown)} of {len(frame)} by mean CUES")
    # More do not fit; --csv and --json have them.
    listed = comparison.names if len(comparison.names) <= LISTED else ()
    numbers = [str(number + 1) for number in range(len(listed))]
    headings = ["mean", "min", "spread", "mean rank", "worst", *numbers]
    output = plain_table("combination", *headings, numbers=len(headings), gap=1)
    output.columns[0].no_wrap = True
    for row in shown.iter_rows(named=True):
        output.add_row(
            row["alternative"],
            *(f"{row[name]:.3f}" for name in ("mean", "min", "spread")),
            f"{row['mean_rank']:.1f}",
            f"{row['worst_rank']:.0f}",
            *("-" if row[name] is None else f"{row[name]:.3f}" for name in listed),
        )
    print_table(console, output)


def _print_machines(console: Console, machines: Machines) -> None:
    from rich.text import Text

    from aerocues.cli.console import print_table
    from aerocues.cli.validation_tables import correlation_text, print_title

    first, second = machines.first, machines.second
    print_title(console, f"\n{first.dataset}: {second.machine} against {first.machine}")
    values = machines.rankings.spearman()[0, 1], machines.rankings.kendall()[0, 1]
    text = " and ".join(map(correlation_text, values))
    console.print(Text(f"rankings by CUES: Spearman and Kendall {text}"))
    if isinstance(machines.times, str):
        console.print(Text(machines.times))
    else:
        print_table(console, _times(machines.times))


def _times(times: pl.DataFrame) -> Any:
    from aerocues.cli.console import plain_table

    headings = ("rows", "first s", "second s", "ratio", "5 - 95 % of rows", "rank correlation")
    output = plain_table("stage", *headings, numbers=len(headings))
    for row in times.iter_rows(named=True):
        correlation = row["rank_correlation"]
        output.add_row(
            row["stage"],
            f"{row['rows']:,}",
            f"{row['first_seconds']:.4f}",
            f"{row['second_seconds']:.4f}",
            f"{row['ratio']:.2f}",
            f"{row['ratio_low']:.2f} - {row['ratio_high']:.2f}",
            "-" if correlation is None else f"{correlation:.3f}",
        )
    return output
