"""The output of `aerocues compare`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from rich.text import Text

from aerocues.cli.console import plain_table, print_table, standard_output
from aerocues.cli.overview_tables import print_machines, print_overview
from aerocues.cli.validation_tables import numbered_matrix, print_title
from aerocues.phrases import count

if TYPE_CHECKING:
    import polars as pl
    from rich.console import Console
    from rich.table import Table

    from aerocues.scoring.compared import ComparedResults, Runs
    from aerocues.scoring.comparison import Comparison
    from aerocues.scoring.joint import JointScores

LISTED = 6
OVER = {"pairwise": "both", "all": "all"}
TESTS = {
    "bootstrap": "Student's t of the resamples",
    "wilcoxon": "Wilcoxon's signed-rank test",
}


def print_compared(found: ComparedResults, top: int, *, reconstruction: bool) -> None:
    """Print all sections; what two runs over the same images differ in comes first."""
    from aerocues.scoring.conditions import told_conditions

    console, entries, comparison = standard_output(), found.entries, found.rankings
    print_title(console, f"{count(len(entries), 'ranking')}, scoring preset {entries[0].preset}")
    for entry, told in zip(
        entries, told_conditions([each.conditions for each in entries]), strict=True
    ):
        number = entry.criteria_of_models
        models = f"with {number} criteria of its models" if number else ""
        conditions = ", ".join(filter(None, (told, entry.machine, models)))
        console.print(Text(f"{entry.name}: {conditions}"))
    if not reconstruction and any(each.reconstructed for each in entries):
        console.print("without the criteria of the reconstruction; --reconstruction adds them")
    for each in found.runs:
        _print_runs(console, each, top)
    told = f"over the {_shared(comparison)} combinations scored in {OVER[comparison.over]}"
    for name, values in (("Spearman", comparison.spearman()), ("Kendall", comparison.kendall())):
        print_title(console, f"\n{name}'s rank correlation, {told}")
        print_table(console, numbered_matrix(comparison.names, values, digits=3))
    if found.overview:
        _print_versatility(console, comparison, top)
        print_overview(console, found.overview, top)


def _shared(comparison: Comparison) -> str:
    shared = comparison.shared()[~np.eye(len(comparison.names), dtype=bool)]
    low, high = shared.min(), shared.max()
    return f"{low:,}" if low == high else f"{low:,} to {high:,}"


def _print_versatility(console: Console, comparison: Comparison, top: int) -> None:
    frame = comparison.versatility()
    shown = frame.head(top)
    over = count(len(comparison.dataset_names), "dataset")
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
            *(_number(row[f"score_{name}"]) for name in listed),
        )
    print_table(console, output)


def _number(value: float | None, form: str = ".3f") -> str:
    return "-" if value is None else f"{value:{form}}"


def _print_runs(console: Console, runs: Runs, top: int) -> None:
    print_title(console, f"\n{runs.title}")
    if isinstance(runs.joint, str):
        console.print(Text(runs.joint))
    else:
        _print_joint(console, runs.joint, top)
    if isinstance(runs.times, str):
        console.print(Text(runs.times))
    else:
        print_title(console, "\ntimes of the same rows: ratio of the second to the first")
        print_table(console, _times(runs.times))
    if isinstance(runs.machines, str):
        console.print(Text(runs.machines))
    elif runs.machines:
        print_machines(console, runs, runs.machines, top)


def _print_joint(console: Console, joint: JointScores, top: int) -> None:
    from aerocues.scoring.significance import LEVEL

    frame, resampled = joint.differences(), joint.resampled
    unit = "sequence" if resampled.unit == "block" else "pair"
    console.print(
        f"scored together: {count(len(frame), 'combination')} on {count(joint.pairs, 'pair')}\n"
        f"p: {TESTS[joint.test]}, {count(resampled.units, unit)}, corrected by Holm"
    )
    print_table(console, _differences(frame.head(top)))
    if len(frame) > top:
        console.print(f"best {top} of {len(frame)}; --csv and --json have all")
    surely = frame.filter(frame["p_value"] < LEVEL)["difference"]
    better, worse = int((surely > 0).sum()), int((surely < 0).sum())
    untested = frame["p_value"].null_count()
    console.print(
        f"significantly better in the second run: {better} of {len(frame)}; worse: {worse}"
        + (f"; not tested, for too few pairs: {untested}" if untested else "")
    )
    if any("seconds" in name for name in joint.scores.table.criterion_names):
        console.print(
            "Times count here, and a machine is not equally fast in two runs: small differences "
            "may be its load.\n--criteria without seconds leaves times out."
        )
    print_title(console, "\ncriteria, means over the combinations")
    print_table(console, _criteria(joint.criteria()))


def _differences(frame: pl.DataFrame) -> Table:
    headings = ("first", "second", "difference", "95 %", "p", "rank", "then")
    output = plain_table("combination", *headings, numbers=len(headings), gap=1)
    output.columns[0].no_wrap = True
    for row in frame.iter_rows(named=True):
        ends = row["difference_low"], row["difference_high"]
        output.add_row(
            row["combination"],
            _number(row["first_score"]),
            _number(row["second_score"]),
            _number(row["difference"], "+.3f"),
            "-" if None in ends else " to ".join(f"{end:+.3f}" for end in ends),
            _number(row["p_value"], ".2g"),
            *(
                "-" if row[name] is None else str(row[name])
                for name in ("first_rank", "second_rank")
            ),
        )
    return output


def _criteria(frame: pl.DataFrame) -> Table:
    output = plain_table("", "first", "second", "difference", "better", "p", numbers=5)
    output.columns[0].no_wrap = True
    for row in frame.iter_rows(named=True):
        output.add_row(
            row["criterion"],
            *(_number(row[name], ".4g") for name in ("first", "second")),
            _number(row["difference"], "+.3g"),
            row["better"],
            _number(row["p_value"], ".2g"),
        )
    return output


def _times(times: pl.DataFrame) -> Any:
    headings = ("rows", "first s", "second s", "ratio", "5 - 95 %", "rank corr.")
    output = plain_table("stage", *headings, numbers=len(headings))
    for row in times.iter_rows(named=True):
        output.add_row(
            row["stage"],
            f"{row['rows']:,}",
            f"{row['first_seconds']:.4f}",
            f"{row['second_seconds']:.4f}",
            f"{row['ratio']:.2f}",
            f"{row['ratio_low']:.2f} - {row['ratio_high']:.2f}",
            _number(row["rank_correlation"]),
        )
    return output
