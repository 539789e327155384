"""`aerocues methods`: lists the methods, chooses combinations and explains them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

import typer

from aerocues.cli.options import (
    DescriptorsOption,
    DetectorsOption,
    EverythingOption,
    JsonOption,
    NoPluginsOption,
    PluginOption,
    WithOption,
    with_sets,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from aerocues.methods.descriptors import DescriptorRow
    from aerocues.methods.detectors import DetectorRow
    from aerocues.methods.matchers import MatcherRow, NormRow
    from aerocues.methods.registry import Methods

    Row = DetectorRow | DescriptorRow | MatcherRow

app = typer.Typer(help="List the methods; choose and explain combinations.")


@app.callback(invoke_without_command=True)
def methods(
    context: typer.Context,
    as_json: JsonOption = False,
    preset: Annotated[
        str, typer.Option(metavar="NAME", help="Show the parameters of this preset or preset file.")
    ] = "default",
    plugin: PluginOption = None,
    no_plugins: NoPluginsOption = False,
) -> None:
    """List the installed methods, with parameters and sources."""
    if context.invoked_subcommand is not None:
        return
    from aerocues.methods.plugins import installed_methods
    from aerocues.methods.presets import preset_named

    chosen = preset_named(preset)
    found = installed_methods().with_preset(chosen)
    if as_json:
        import json

        typer.echo(json.dumps(_facts(found, chosen.name), indent=2))
    else:
        _print_methods(found, chosen.name)


@app.command()
def why(
    combinations: Annotated[
        list[str],
        typer.Argument(metavar="COMBINATION", help="Combination, such as SIFT-ORB-HAM-BF."),
    ],
    plugin: PluginOption = None,
    no_plugins: NoPluginsOption = False,
) -> None:
    """Tell whether a combination can run, and if not, why."""
    from aerocues.methods.explanation import explain
    from aerocues.methods.plugins import installed_methods

    installed = installed_methods()
    for combination in combinations:
        typer.echo(explain(combination, installed))


@app.command("list")
def list_combinations(
    globs: Annotated[
        str | None,
        typer.Argument(metavar="GLOBS", help="Combinations, such as 'ORB-*-HAM-BF,!*-BOOST-*'."),
    ] = None,
    detectors: DetectorsOption = None,
    descriptors: DescriptorsOption = None,
    sets: WithOption = None,
    everything: EverythingOption = False,
    plugin: PluginOption = None,
    no_plugins: NoPluginsOption = False,
) -> None:
    """Print the selected combinations, one per line."""
    from aerocues.methods.plugins import installed_methods
    from aerocues.methods.selection import select

    chosen = select(
        installed_methods(),
        with_sets(globs, sets),
        detectors=detectors,
        descriptors=descriptors,
        everything=everything,
    )
    for combination in chosen:
        typer.echo(str(combination))


@dataclass(frozen=True)
class _Shown:
    """The rows that are listed: not those that stand for what pair matchers do without."""

    detectors: Sequence[DetectorRow]
    descriptors: Sequence[DescriptorRow]
    norms: Sequence[NormRow]
    matchers: Sequence[MatcherRow]
    pair_matchers: Sequence[MatcherRow]

    @classmethod
    def of(cls, found: Methods) -> _Shown:
        from aerocues.methods.combination import NONE

        return cls(
            [row for row in found.detectors.values() if not row.of_pairs],
            [row for row in found.descriptors.values() if row.name != NONE],
            [row for row in found.norms.values() if row.name != NONE],
            [row for row in found.matchers.values() if not row.of_pairs],
            [row for row in found.matchers.values() if row.of_pairs],
        )


def _describe(row: Row) -> dict[str, Any]:
    return {
        "name": row.name,
        "parameters": dict(row.parameters),
        "origin": row.origin,
        "reference": row.reference,
        "on_request": row.on_request,
        "upright": row.upright,
        "unavailable": row.unavailable,
    }


def _facts(found: Methods, preset: str) -> dict[str, Any]:
    from dataclasses import asdict

    from aerocues.methods.counting import count_combinations, count_on_request
    from aerocues.methods.registry import opencv_methods

    shown = _Shown.of(found)
    on_request = count_on_request(found)
    return {
        **asdict(count_combinations(found)),
        "opencv": asdict(count_combinations(opencv_methods())),
        "on_request": {name: asdict(counts) for name, counts in on_request.items()},
        "preset": preset,
        "detectors": [_describe(row) for row in shown.detectors],
        "descriptors": [{**_describe(row), "dtype": row.dtype} for row in shown.descriptors],
        "norms": [{"name": row.name, "title": row.title} for row in shown.norms],
        "matchers": [
            {
                **_describe(row),
                "title": row.title,
                "takes_descriptors": list(row.takes_descriptors),
            }
            for row in shown.matchers
        ],
        "pair_matchers": [{**_describe(row), "title": row.title} for row in shown.pair_matchers],
        "problems": list(found.problems),
    }


def _parameters(row: Row) -> str:
    if row.unavailable:
        return f"unavailable: {row.unavailable}"
    parameters = ", ".join(f"{name}={value}" for name, value in row.parameters.items())
    request = f"on request: +{row.on_request}" if row.on_request else ""
    told = (parameters or "no parameters", request, "upright" if row.upright else "")
    return "; ".join(filter(None, told))


def _print_methods(found: Methods, preset: str) -> None:
    from rich.text import Text

    from aerocues.cli.console import plain_table, print_table, standard_output
    from aerocues.methods.counting import count_combinations, count_on_request

    table, shown = plain_table(), _Shown.of(found)
    sections: tuple[tuple[str, Sequence[Row]], ...] = (
        ("Detectors", shown.detectors),
        ("Descriptors", shown.descriptors),
        ("Matchers", shown.matchers),
        ("Pair matchers", shown.pair_matchers),
    )
    for title, rows in sections:
        if rows:
            table.add_row(Text(title, style="bold"))
        for row in rows:
            brought_by = "" if row.origin == "opencv" else f" (from {row.origin})"
            style = "yellow" if row.unavailable else "dim"
            table.add_row(Text(f"  {row.name}"), Text(f"{row.reference}{brought_by}"))
            table.add_row(Text(), Text(_parameters(row), style=style))
        if rows:
            table.add_row()
    console = standard_output()
    print_table(console, table)
    counts = count_combinations(found)
    console.print(f"Norms: {', '.join(f'{n.name} ({n.title})' for n in shown.norms)}")
    console.print(f"Parameters are those of the preset {preset}.\n")
    console.print(_counted(counts.declared, "combinations in all"))
    console.print(_counted(counts.runnable, "of these can run (run --all)"))
    console.print(_counted(counts.meaningful, "of these are meaningful (the default selection)"))
    for cause, number in counts.incompatible.items():
        console.print(_counted(number, f"cannot: {cause}"), style="dim")
    if counts.unavailable:
        console.print(_counted(counts.unavailable, "cannot here: unavailable"), style="yellow")
    for name, each in count_on_request(found).items():
        console.print(_counted(each.meaningful, f"more on request (+{name})"))
    for problem in found.problems:
        console.print(Text(f"\nProblem: {problem}", style="yellow"))
    console.print("\nTo see why one cannot run: aerocues methods why SIFT-ORB-HAM-BF")


def _counted(number: int, what: str) -> str:
    return f"{number:>6,}  {what}"
