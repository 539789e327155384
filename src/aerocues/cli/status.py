"""`aerocues status`: the progress of a run."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from aerocues.cli.options import JsonOption, ResultsArgument

if TYPE_CHECKING:
    from rich.table import Table

    from aerocues.results.measured_results import Results, RunStatus

LONGEST_MESSAGE = 160
LONGEST_LIST = 40
EXAMPLES = 3
# OpenCV puts its version and a path of the machine that built it before what it has to say.
OPENCV_PREFIX = re.compile(r"OpenCV\([^)]*\) \S+: error: ")


def status(
    folder: ResultsArgument,
    as_json: JsonOption = False,
    verify: Annotated[
        bool, typer.Option("--verify", help="Check every file of the folder for damage.")
    ] = False,
) -> None:
    """Show the progress of a run, with reasons of failures.

    With --verify the exit code is 1 if a file is damaged.
    """
    import aerocues

    results = aerocues.Results(folder)
    if verify:
        _verify(results, as_json=as_json)
        return
    found = results.status()
    if as_json:
        _print_json(found)
    else:
        _print_status(found, folder)


def _verify(results: Results, *, as_json: bool) -> None:
    """Say which files are damaged; exit code 1 if any is."""
    from aerocues.cli.output import print_json
    from aerocues.phrases import count

    checked = results.verify()
    damaged = [each for each in checked if each.problem]
    unchecked = sum(not each.has_checksum for each in checked)
    if as_json:
        told = [{"file": str(each.file), "problem": each.problem} for each in damaged]
        print_json({"files": len(checked), "without_checksum": unchecked, "damaged": told})
    else:
        for each in damaged:
            typer.echo(str(each))
        typer.echo(f"{count(len(checked), 'file')} checked, {len(damaged) or 'none'} damaged")
        if unchecked:
            typer.echo(
                f"{count(unchecked, 'file')} of an older version without a checksum: read through, "
                "but a changed value in them cannot be seen"
            )
    if damaged:
        raise typer.Exit(1)


def _print_json(found: RunStatus) -> None:
    import json

    facts = {
        "planned": found.planned,
        "done": found.done,
        "left": found.left,
        "statuses": dict(found.statuses),
        "failures": found.failures.to_dicts(),
        "exclusions": found.exclusions,
        "timings": dict(found.timings),
        "disturbed": found.disturbed,
        "untimed": found.untimed,
    }
    typer.echo(json.dumps(facts, indent=2))


def _print_status(found: RunStatus, folder: Path) -> None:
    from rich.text import Text

    from aerocues.cli.console import plain_table, print_table, standard_output

    console = standard_output()
    left = f", {found.left:,} left" if found.left else ", none left"
    left += f"; {found.untimed:,} of them still to be timed alone" if found.untimed else ""
    console.print(Text(f"{found.done:,} of {found.planned:,} rows done{left}", style="bold"))
    by_status = plain_table("", "rows", numbers=1)
    for name, number in found.statuses.items():
        by_status.add_row(f"  {name}", f"{number:,}")
    if found.statuses:
        print_table(console, by_status)
    if found.timings:
        console.print(Text(f"times: {times_of(found.timings, found.disturbed)}"))
    if len(found.failures):
        console.print(Text("\nnot ok, by reason and methods", style="bold"))
        print_table(console, _failures(found))
        if len(found.failures) > LONGEST_LIST:
            console.print(f"and {len(found.failures) - LONGEST_LIST} more; --json prints all")
    if found.exclusions:
        console.print(Text("\nleft out because of the images", style="bold"))
        for line in _exclusions(found):
            console.print(Text(f"  {line}"))
    if found.left or found.untimed:
        first = "unzip it and " if folder.is_file() else ""
        where = "FOLDER" if folder.is_file() else folder
        told = f"{first}run the same command again (-o {where}) to continue"
        console.print(Text(f"\n{told}"))


def times_of(timings: Mapping[str, int], disturbed: int) -> str:
    """``exclusive 1,700 (2 disturbed by other programs), scaled 4,080``."""
    said = f" ({disturbed:,} disturbed by other programs)" if disturbed else ""
    return ", ".join(
        f"{name} {number:,}{said if name == 'exclusive' else ''}"
        for name, number in timings.items()
    )


def _exclusions(found: RunStatus) -> Iterator[str]:
    """A line for each reason and number of pairs."""
    from aerocues.phrases import count

    combinations: defaultdict[tuple[str, int], list[str]] = defaultdict(list)
    for exclusion in found.exclusions:
        key = (exclusion["reason"], exclusion["pairs"])
        combinations[key].append(exclusion["combination"])
    for (reason, pairs), names in combinations.items():
        yield f"{_together(names)} on {count(pairs, 'pair')}: {reason}"


def _together(names: Sequence[str]) -> str:
    """Combinations in few words: by the detector and descriptor that they share, if any."""
    if len(names) == 1:
        return names[0]
    methods = zip(*(name.split("-")[:2] for name in names), strict=True)
    shared = "-".join(kinds[0] for kinds in methods if len(set(kinds)) == 1)
    examples = ", ".join(names[:EXAMPLES]) + (", ..." if len(names) > EXAMPLES else "")
    return f"{len(names):,} combinations " + (f"with {shared}" if shared else f"({examples})")


def _failures(found: RunStatus) -> Table:
    from rich.text import Text

    from aerocues.cli.console import plain_table

    table = plain_table("status", "rows", "methods", "example")
    table.columns[1].justify = "right"
    for row in found.failures.head(LONGEST_LIST).iter_rows(named=True):
        message = OPENCV_PREFIX.sub("OpenCV: ", " ".join((row["message"] or "").split()))
        methods = f"{row['detector']}-{row['descriptor']}"
        table.add_row(row["status"], f"{row['rows']:,}", methods, Text(message[:LONGEST_MESSAGE]))
    return table
