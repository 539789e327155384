"""`aerocues compare`: rankings across datasets and machines."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from aerocues.cli.options import JsonOption, ResultsArguments, TopOption
from aerocues.cli.output import STANDARD_OUTPUT, print_json, write_table
from aerocues.cli.scoring import (
    AggregationOption,
    AlphaOption,
    CriteriaOption,
    FailuresOption,
    PresetOption,
    WeightsOption,
)

if TYPE_CHECKING:
    import polars as pl
    from rich.console import Console

    from aerocues.scoring.across import ComparedResults, Machines
    from aerocues.scoring.comparison import Comparison


LISTED = 6
OVER = {"pairwise": "both", "all": "all"}


class Over(StrEnum):
    """Values of ``--over``."""

    PAIRWISE = "pairwise"
    ALL = "all"


def compare(
    results: ResultsArguments,
    preset: PresetOption = None,
    criteria: CriteriaOption = None,
    failures: FailuresOption = None,
    alpha: AlphaOption = None,
    weights: WeightsOption = None,
    aggregation: AggregationOption = None,
    reconstruction: Annotated[
        bool, typer.Option("--reconstruction", help="Also score the 3D models, in all results.")
    ] = False,
    over: Annotated[
        Over,
        typer.Option(
            help="Compare combinations that are scored in both of two results, or in all."
        ),
    ] = Over.PAIRWISE,
    top: TopOption = 15,
    as_json: JsonOption = False,
    csv: Annotated[
        str | None,
        typer.Option(metavar="FILE", help="Write scores and ranks as CSV; - is standard output."),
    ] = None,
    factors: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Write how much longer each stage takes in the second results than in the first, "
            "for 'recommend --device'.",
        ),
    ] = None,
) -> None:
    """Compare rankings across datasets, and times across machines."""
    import aerocues
    from aerocues.cli.interruption import interruptible

    with interruptible():
        found = aerocues.compare(
            results,
            preset,
            criteria=criteria,
            reconstruction=reconstruction,
            failures=failures.value if failures else None,
            alpha=alpha,
            weights=weights,
            aggregation=aggregation,
            over=over.value,
        )
        if factors is not None:
            _write_factors(found, factors)
    if csv is not None:
        write_table(found.frame(), csv, "csv", "combination")
    if csv == STANDARD_OUTPUT:
        return
    if as_json:
        print_json(_facts(found))
    else:
        _print(found, top, reconstruction=reconstruction)


def _write_factors(found: ComparedResults, file: Path) -> None:
    from aerocues.results.export import write_file
    from aerocues.results.whole_files import json_content

    write_file(file, json_content(found.factors()))


def _facts(found: ComparedResults) -> dict[str, Any]:
    from aerocues.cli.validate import matrix_facts

    entries, comparison = found.entries, found.rankings
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
        "versatility": found.frame().to_dicts(),
        "machines": [
            {
                "first": each.first.name,
                "second": each.second.name,
                "spearman": float(each.rankings.spearman()[0, 1]),
                "kendall": float(each.rankings.kendall()[0, 1]),
                "ranks": each.ranks().to_dicts(),
                "times": each.times if isinstance(each.times, str) else each.times.to_dicts(),
            }
            for each in found.machines
        ],
    }


def _print(found: ComparedResults, top: int, *, reconstruction: bool) -> None:
    import numpy as np

    from aerocues.cli.console import print_table, standard_output
    from aerocues.cli.validation_tables import numbered_matrix, print_title
    from aerocues.phrases import count

    console, entries, comparison = standard_output(), found.entries, found.rankings
    shared = comparison.shared()[~np.eye(len(entries), dtype=bool)]
    number = (
        f"{shared.min():,}"
        if shared.min() == shared.max()
        else f"{shared.min():,} to {shared.max():,}"
    )
    told = f"over the {number} combinations scored in {OVER[comparison.over]}"
    print_title(console, f"{count(len(entries), 'ranking')}, preset {entries[0].preset}")
    if not reconstruction and any(each.reconstructed for each in entries):
        console.print("without the criteria of the reconstruction; --reconstruction adds them")
    for name, values in (("Spearman", comparison.spearman()), ("Kendall", comparison.kendall())):
        print_title(console, f"\n{name}'s rank correlation, {told}")
        print_table(console, numbered_matrix(comparison.names, values))
    _print_versatility(console, comparison, top)
    for each in found.machines:
        _print_machines(console, each, top)


def _print_versatility(console: Console, comparison: Comparison, top: int) -> None:
    from aerocues.cli.console import plain_table, print_table
    from aerocues.cli.validation_tables import print_title
    from aerocues.phrases import count

    frame = comparison.versatility()
    shown = frame.head(top)
    over = count(len(set(comparison.datasets)), "data set")
    best = f"best {len(shown)} of {len(frame)} by mean CUES"
    print_title(console, f"\nversatility on {over}: {best}")
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
            *(_score(row[f"score_{name}"]) for name in listed),
        )
    print_table(console, output)


def _score(value: float | None) -> str:
    return "-" if value is None else f"{value:.3f}"


def _print_machines(console: Console, machines: Machines, top: int) -> None:
    from rich.text import Text

    from aerocues.cli.console import print_table
    from aerocues.cli.validation_tables import correlation_text, print_title

    first, second = machines.first, machines.second
    print_title(console, f"\n{first.dataset}: {second.machine} against {first.machine}")
    values = machines.rankings.spearman()[0, 1], machines.rankings.kendall()[0, 1]
    text = " and ".join(map(correlation_text, values))
    console.print(Text(f"rankings by CUES: Spearman and Kendall {text}"))
    print_table(console, _side_by_side(machines, top))
    if isinstance(machines.times, str):
        console.print(Text(machines.times))
    else:
        print_table(console, _times(machines.times))


def _side_by_side(machines: Machines, top: int) -> Any:
    """Scores and ranks on both machines, by the rank on the first."""
    from aerocues.cli.console import plain_table

    headings = ("first: rank", "CUES", "second: rank", "CUES", "shift")
    output = plain_table("combination", *headings, numbers=len(headings))
    output.columns[0].no_wrap = True
    for row in machines.ranks().head(top).iter_rows(named=True):
        ranks = (row["first_rank"], row["second_rank"])
        shift = "-" if None in ranks else f"{ranks[1] - ranks[0]:+d}"
        first, second = ("-" if rank is None else f"{rank}" for rank in ranks)
        scores = _score(row["first_score"]), _score(row["second_score"])
        output.add_row(row["combination"], first, scores[0], second, scores[1], shift)
    return output


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
