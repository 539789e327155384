"""`aerocues run --dry-run`: what would be measured, and what is left out and why."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from aerocues.cli.console import standard_output
from aerocues.phrases import count

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from aerocues.evaluation.plan import Plan
    from aerocues.results.timing import Timing

SELECTION = ("combinations", "detectors", "descriptors", "everything")
LONGEST_LIST = 10


def print_plan(arguments: dict[str, Any]) -> None:
    """Print what `aerocues.run` would do with `arguments`."""
    from aerocues.cli.live import display
    from aerocues.evaluation.run import plan_run
    from aerocues.methods.counting import count_left_out, named
    from aerocues.methods.plugins import installed_methods
    from aerocues.methods.selection import select
    from aerocues.phrases import spoken_seconds

    methods = installed_methods()
    patterns, detectors, descriptors, everything = (arguments[name] for name in SELECTION)
    kept = {"detectors": detectors, "descriptors": descriptors}
    chosen = select(methods, patterns, **kept, everything=everything)
    with display() as tally:
        turns = plan_run(**arguments, progress=tally)
    plan = turns[0][1]
    asked = named(methods, patterns, **kept)
    left_out = count_left_out(asked, frozenset(chosen), methods)
    dataset = arguments["dataset"]
    images = count(len(dataset.images), "image")
    pairs = count(len({row.pair for row in plan.rows}), "pair")
    seconds = sum(unit.cost for _, each in turns for unit in each.units)
    lines = [
        f"dataset       {dataset.name}: {images}, {pairs}",
        f"combinations  {len(chosen):,} of the {len(asked):,} named",
        *(f"              {number:>5,} left out: {cause}" for cause, number in left_out.items()),
        f"rows          {plan.rows_planned:,}, of which {plan.rows_present:,} are there already",
        *_ruled_out(plan),
        *_work(turns),
        f"CPU time      roughly {spoken_seconds(seconds)} at 1000 x 600 pixels",
        "Nothing was measured or written.",
    ]
    console = standard_output()
    for line in lines:
        console.print(line, soft_wrap=True, markup=False)


def _work(turns: Sequence[tuple[Timing, Plan]]) -> Iterator[str]:
    """What is left to do, a line a pass."""
    for timing, plan in turns:
        rows, units = count(plan.rows_left, "row"), count(len(plan.units), "unit")
        head = "timed alone" if timing == "exclusive" else "work"
        yield f"{head:12s}  {rows} in {units} (a detector on a few pairs)"


def _ruled_out(plan: Plan) -> list[str]:
    """What the images rule out."""
    lines = [
        f"              left out: {exclusion.combination} on {count(exclusion.pairs, 'pair')}, "
        f"because {exclusion.reason}"
        for exclusion in plan.exclusions[:LONGEST_LIST]
    ]
    if len(plan.exclusions) > LONGEST_LIST:
        lines.append(f"              and {len(plan.exclusions) - LONGEST_LIST:,} more")
    return lines
