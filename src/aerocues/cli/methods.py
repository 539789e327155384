"""`aerocues methods`: lists the methods, chooses combinations and explains them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from aerocues.cli.options import (
    DescriptorsOption,
    DetectorsOption,
    EverythingOption,
    JsonOption,
    NoPluginsOption,
    PluginOption,
)

if TYPE_CHECKING:
    from collections.abc import Mapping

    from aerocues.methods.descriptors import DescriptorRow
    from aerocues.methods.detectors import DetectorRow
    from aerocues.methods.matchers import MatcherRow
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
    everything: EverythingOption = False,
    plugin: PluginOption = None,
    no_plugins: NoPluginsOption = False,
) -> None:
    """Print the selected combinations, one per line."""
    from aerocues.methods.plugins import installed_methods
    from aerocues.methods.selection import select

    chosen = select(
        installed_methods(),
        globs,
        detectors=detectors,
        descriptors=descriptors,
        everything=everything,
    )
    for combination in chosen:
        typer.echo(str(combination))


def _describe(row: Row) -> dict[str, Any]:
    return {
        "name": row.name,
        "parameters": dict(row.parameters),
        "origin": row.origin,
        "reference": row.reference,
        "upright": row.upright,
        "unavailable": row.unavailable,
    }


def _facts(found: Methods, preset: str) -> dict[str, Any]:
    from dataclasses import asdict

    from aerocues.methods.counting import count_combinations
    from aerocues.methods.registry import opencv_methods

    return {
        **asdict(count_combinations(found)),
        "opencv": asdict(count_combinations(opencv_methods())),
        "preset": preset,
        "detectors": [_describe(row) for row in found.detectors.values()],
        "descriptors": [
            {**_describe(row), "dtype": row.dtype} for row in found.descriptors.values()
        ],
        "norms": [{"name": row.name, "title": row.title} for row in found.norms.values()],
        "matchers": [
            {
                **_describe(row),
                "title": row.title,
                "takes_descriptors": list(row.takes_descriptors),
            }
            for row in found.every_matcher.values()
        ],
        "problems": list(found.problems),
    }


def _parameters(row: Row) -> str:
    if row.unavailable:
        return f"unavailable: {row.unavailable}"
    parameters = ", ".join(f"{name}={value}" for name, value in row.parameters.items())
    return f"{parameters or 'no parameters'}{'; upright' if row.upright else ''}"


def _print_methods(found: Methods, preset: str) -> None:
    from rich.text import Text

    from aerocues.cli.console import plain_table, print_table, standard_output
    from aerocues.methods.counting import count_combinations

    table = plain_table()
    sections: tuple[tuple[str, Mapping[str, Row]], ...] = (
        ("Detectors", found.detectors),
        ("Descriptors", found.descriptors),
        ("Matchers", found.every_matcher),
    )
    for title, rows in sections:
        table.add_row(Text(title, style="bold"))
        for row in rows.values():
            brought_by = "" if row.origin == "opencv" else f" (from {row.origin})"
            style = "yellow" if row.unavailable else "dim"
            table.add_row(Text(f"  {row.name}"), Text(f"{row.reference}{brought_by}"))
            table.add_row(Text(), Text(_parameters(row), style=style))
        table.add_row()
    console = standard_output()
    print_table(console, table)
    counts = count_combinations(found)
    console.print(f"Norms: {', '.join(f'{n.name} ({n.title})' for n in found.norms.values())}")
    console.print(f"Parameters are those of the preset {preset}.\n")
    console.print(_counted(counts.declared, "combinations in all"))
    console.print(_counted(counts.runnable, "of these can run (run --all)"))
    console.print(_counted(counts.meaningful, "of these are meaningful (the default selection)"))
    for cause, number in counts.incompatible.items():
        console.print(_counted(number, f"cannot: {cause}"), style="dim")
    if counts.unavailable:
        console.print(_counted(counts.unavailable, "cannot here: unavailable"), style="yellow")
    for problem in found.problems:
        console.print(Text(f"\nProblem: {problem}", style="yellow"))
    console.print("\nTo see why one cannot run: aerocues methods why SIFT-ORB-HAM-BF")


def _counted(number: int, what: str) -> str:
    return f"{number:>6,}  {what}"
