"""`aerocues recommend`: finds the best combination within a budget of time."""

from __future__ import annotations

import shlex
import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from aerocues.cli.limit_options import (
    LicenceOption,
    Limits,
    MaxBytesOption,
    MaxMemoryOption,
    MaxSecondsOption,
    Objective,
)
from aerocues.cli.options import (
    BandOption,
    CombinationsOption,
    EqualizeOption,
    EveryOption,
    JsonOption,
    MaxKeypointsOption,
    MaxWidthOption,
    MethodPresetOption,
    NoPluginsOption,
    PairsOption,
    PluginOption,
    SeedOption,
    SubsetOption,
    TopOption,
    UprightOption,
    WithOption,
    WorkersOption,
    given_options,
    with_sets,
)
from aerocues.cli.serving import LiveOption
from aerocues.defaults import FLIGHT_KEYPOINTS, RACE_PAIRS, RACE_SECONDS, RACE_WIDTH, SURE

if TYPE_CHECKING:
    from aerocues.cli.next_commands import AsMeasured
    from aerocues.datasets.dataset import Dataset
    from aerocues.tuning.recommendation import Recommendation


# All other options belong to a race.
OF_RESULTS = {
    *("results", "objective", "combinations", "top", "seed", "plugin", "no_plugins", "as_json"),
    *Limits.__dataclass_fields__,
}


def recommend(
    context: typer.Context,
    dataset: Annotated[
        str | None,
        typer.Argument(
            metavar="DATASET",
            help="A folder of images, or one of the kinds that 'aerocues datasets' lists.",
            show_default=False,
        ),
    ] = None,
    results: Annotated[
        list[Path] | None,
        typer.Option(
            "--from",
            metavar="RESULTS",
            help="Choose from finished results in place of measuring; may be repeated.",
        ),
    ] = None,
    budget: Annotated[
        str, typer.Option(metavar="TIME", help="Total time, such as 90s, 5min or 1h.")
    ] = f"{RACE_SECONDS / 60:g}min",
    objective: Annotated[
        Objective, typer.Option(help="What the combination is used for.")
    ] = Objective.BALANCED,
    final: Annotated[
        bool,
        typer.Option("--final/--no-final", help="Let models of the leaders decide, or the race."),
    ] = True,
    top: TopOption = 5,
    device: Annotated[
        Path | None,
        typer.Option(
            metavar="FACTORS", help="Use the times of another machine, from 'compare --factors'."
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="DIR",
            help="Results folder, created or continued; by default NAME-race.",
        ),
    ] = None,
    explain: Annotated[
        bool, typer.Option("--explain", help="Show the rounds of the race.")
    ] = False,
    report: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write a report page.")
    ] = None,
    live: LiveOption = False,
    combinations: CombinationsOption = None,
    sets: WithOption = None,
    preset: MethodPresetOption = "default",
    max_keypoints: MaxKeypointsOption = FLIGHT_KEYPOINTS,
    max_width: MaxWidthOption = RACE_WIDTH,
    pairs: PairsOption = None,
    max_pairs: Annotated[
        int, typer.Option(min=2, metavar="N", help="Maximum number of representative pairs.")
    ] = RACE_PAIRS,
    subset: SubsetOption = None,
    band: BandOption = None,
    every: EveryOption = None,
    equalize: EqualizeOption = "none",
    sure: Annotated[
        float,
        typer.Option(
            min=0.5,
            max=1.0,
            metavar="P",
            help="End the race when the leader is this likely the best.",
        ),
    ] = SURE,
    workers: WorkersOption = None,
    upright: UprightOption = False,
    seed: SeedOption = 0,
    plugin: PluginOption = None,
    no_plugins: NoPluginsOption = False,
    max_seconds_per_image: MaxSecondsOption = None,
    max_memory: MaxMemoryOption = None,
    max_descriptor_bytes: MaxBytesOption = None,
    licence: LicenceOption = None,
    as_json: JsonOption = False,
) -> None:
    """Recommend a combination for images, in minutes.

    Combinations race on representative pairs: the cheap ones first, then those that can still
    win. A third of the time is kept for models of the leaders, beside COLMAP's default: the best
    model decides. After an interruption run the same command again: it continues.

    With --from finished results, of one or several datasets, are scored at once, within limits of
    time, memory, size and licence.
    """
    began = time.monotonic()
    limits = Limits(max_seconds_per_image, max_memory, max_descriptor_bytes, licence)
    if results:
        _refuse_measuring(context)
        _from_results(results, objective, combinations, limits, top, seed, as_json=as_json)
        return
    if dataset is None:
        raise typer.BadParameter("give DATASET to measure its images, or --from with results")
    _check_race(limits, as_json=as_json)
    import aerocues
    from aerocues.cli.console import tell_images
    from aerocues.cli.interruption import interruptible
    from aerocues.cli.next_commands import AsMeasured
    from aerocues.cli.serving import display_and_page

    with interruptible():
        images = aerocues.open_dataset(
            dataset,
            pairs=pairs,
            max_width=max_width,
            equalize=equalize,
            subset=subset,
            band=band,
            every=every,
        )
        folder = output or Path(f"{images.name}-race")
        tell_images(images)
        with display_and_page(folder, live=live) as (_, progress):
            found = aerocues.recommend(
                images,
                with_sets(combinations, sets),
                folder,
                budget=budget,
                objective=objective.value,
                final=final,
                sure=sure,
                max_pairs=max_pairs,
                max_keypoints=max_keypoints,
                preset=preset,
                device=device,
                upright=upright,
                seed=seed,
                workers=workers,
                began=began,
                progress=progress,
            )
        shrunk = _shrunk(images, max_width)
        _print(found, top, shrunk, explain=explain)
        opened = (dataset, pairs, subset, band, every, equalize, shrunk)
        same = AsMeasured(*opened, preset, max_keypoints, seed, tuple(plugin or ()), upright)
        _print_next(found, same)
        if report is not None:
            _write_report(found, report)


def _refuse_measuring(context: typer.Context) -> None:
    """Raise a usage error where something was given that only a race takes."""
    for name, written in given_options(context).items():
        if name not in OF_RESULTS:
            raise typer.BadParameter(
                f"{written} is for measuring, and --from for finished results; give one of the two"
            )


def _from_results(
    results: list[Path],
    objective: Objective,
    combinations: str | None,
    limits: Limits,
    top: int,
    seed: int,
    *,
    as_json: bool,
) -> None:
    import aerocues
    from aerocues.cli.choice_table import choice_facts, print_choice
    from aerocues.cli.interruption import interruptible
    from aerocues.cli.output import print_json

    with interruptible():
        found = aerocues.choose(
            results, objective.value, combinations=combinations, seed=seed, **limits.given()
        )
    if as_json:
        print_json(choice_facts(found))
    else:
        print_choice(found, top)


def _check_race(limits: Limits, *, as_json: bool) -> None:
    """Raise a usage error where an option belongs to finished results only."""
    for name in limits.given():
        option = f"--{name.replace('_', '-')}"
        raise typer.BadParameter(f"{option} chooses among finished results; give --from, too")
    if as_json:
        raise typer.BadParameter("--json is for finished results; give --from, too")


def _print(found: Recommendation, top: int, shrunk: int, *, explain: bool) -> None:
    from aerocues.cli.console import print_table, standard_output
    from aerocues.cli.final_words import final_table
    from aerocues.cli.recommendation import answer, quality_note, ranking, story

    console = standard_output()
    if explain:
        console.print(f"{found.objective.name}: {found.objective.definition}\n", markup=False)
        print_table(console, story(found.outcome))
        console.print()
    console.print(answer(found, shrunk), soft_wrap=True, markup=False)
    console.print()
    if found.final and found.final.rows:
        print_table(console, final_table(found.final, found.ranked["combination"].to_list()))
        console.print("\nThe race on pairs:\n")
    print_table(console, ranking(found, top))
    console.print(f"* {quality_note(found)}; medians.")
    console.print(
        "Scores are expected values of a full measurement; brute force is timed on a sample."
    )


def _shrunk(dataset: Dataset, max_width: int | None) -> int:
    """The width that images were shrunk to; 0 where they are small enough as they are."""
    if not max_width:
        return 0
    from aerocues.pipeline.equal_footing import survey_image

    width = survey_image(dataset.images).read().bgr.shape[1]
    return max_width if width == max_width else 0


def _print_next(found: Recommendation, measured: AsMeasured) -> None:
    from aerocues.cli.console import standard_output
    from aerocues.cli.next_commands import next_commands

    console = standard_output()
    console.print(f"\nresults  {shlex.quote(str(found.folder))}", soft_wrap=True, markup=False)
    label = "next"
    for command in next_commands(found, measured):
        console.print(f"{label:9}{command}", soft_wrap=True, markup=False)
        label = ""


def _write_report(found: Recommendation, file: Path) -> None:
    import aerocues

    page = aerocues.write_report(
        aerocues.Results(found.folder), file, title=f"A race on {found.dataset.name}"
    )
    typer.echo(f"report   {page}")
