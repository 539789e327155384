"""`aerocues recommend`: which combination to take, within a budget of time."""

from __future__ import annotations

import shlex
import sys
import time
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from aerocues.cli.next_commands import AsMeasured
    from aerocues.datasets.dataset import Dataset
    from aerocues.tuning.recommend import RaceOptions, Recommendation

WIDTH = 1000
# As `aerocues.reconstruction.protocol.MAX_KEYPOINTS`, which takes longer to import than help may.
KEYPOINTS = 8000


class Objective(StrEnum):
    """Values of ``--objective``."""

    BALANCED = "balanced"
    SPEED = "speed"
    ACCURACY = "accuracy"
    RECONSTRUCTION = "reconstruction"
    ROBUST = "robust"


def recommend(
    images: Annotated[
        str, typer.Argument(help="A folder, or one of the kinds that 'aerocues datasets' lists.")
    ],
    budget: Annotated[
        str, typer.Option(metavar="TIME", help="Such as 90s, 5min or 1h, all included.")
    ] = "5min",
    objective: Annotated[
        Objective, typer.Option(help="What the best is to be best for.")
    ] = Objective.BALANCED,
    top: Annotated[int, typer.Option(min=1, metavar="N", help="Length of the table.")] = 5,
    device: Annotated[
        Path | None,
        typer.Option(
            metavar="FACTORS", help="Times as on another machine: from 'compare --factors'."
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="DIR", help="Results folder; NAME-race by default."),
    ] = None,
    explain: Annotated[bool, typer.Option("--explain", help="Show the race.")] = False,
    report: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write the page of what was measured.")
    ] = None,
    combinations: Annotated[
        str | None, typer.Option(metavar="GLOBS", help="These only, such as 'ORB-*,SIFT-SIFT-*'.")
    ] = None,
    preset: Annotated[
        str,
        typer.Option(
            metavar="NAME", help="Parameters: default, thesis, tuned, or a preset's file."
        ),
    ] = "default",
    max_keypoints: Annotated[
        int, typer.Option(min=0, metavar="N", help="The strongest of an image; 0: all.")
    ] = KEYPOINTS,
    max_width: Annotated[
        int, typer.Option(min=0, metavar="PIXELS", help="Shrink wider images; 0: as they are.")
    ] = WIDTH,
    pairs: Annotated[
        str | None,
        typer.Option(
            help="consecutive[:K], exhaustive, gps[:K|:50m], overlap:0.3-0.9 or a file of pairs."
        ),
    ] = None,
    max_pairs: Annotated[
        int, typer.Option(min=2, metavar="N", help="So many pairs stand for all, at most.")
    ] = 24,
    subset: Annotated[
        str | None, typer.Option(metavar="GLOBS", help="These images or folders only.")
    ] = None,
    equalize: Annotated[
        str, typer.Option(metavar="HOW", help="Illumination: none, histogram or clahe.")
    ] = "none",
    sure: Annotated[
        float, typer.Option(min=0.5, max=1.0, help="Probability at which the race may end.")
    ] = 0.95,
    workers: Annotated[
        int | None, typer.Option(min=1, metavar="N", help="Processes; one a core by default.")
    ] = None,
    seed: Annotated[
        int, typer.Option(min=0, max=2**31 - 1, metavar="N", help="Seed of all that is random.")
    ] = 0,
) -> None:
    """Tell which combination to take, in minutes.

    Combinations race on pairs of the images: cheap ones are looked at first, then those that can
    still win. Stop at any moment and run the same command again: it goes on.
    """
    began = time.monotonic()
    from aerocues.cli.durations import parse_duration
    from aerocues.cli.interruption import interruptible
    from aerocues.cli.next_commands import AsMeasured
    from aerocues.datasets.catalog import open_dataset
    from aerocues.tuning.device import read_device
    from aerocues.tuning.recommend import RaceOptions

    with interruptible():
        dataset = open_dataset(
            images, pairs=pairs, max_width=max_width, equalize=equalize, subset=subset
        )
        options = RaceOptions(
            budget=parse_duration(budget, "--budget"),
            objective=objective.value,
            sure=sure,
            pairs=max_pairs,
            seed=seed,
            device=read_device(device) if device else None,
            began=began,
        )
        arguments = {
            "output": output or Path(f"{dataset.name}-race"),
            "combinations": combinations,
            "preset": preset,
            "limit": _limit(max_keypoints),
            "limits": _limits(workers),
        }
        found = _race(dataset, options, arguments)
        _print(found, top, explain=explain)
        width = _shrunk(dataset, max_width)
        same = AsMeasured(images, pairs, subset, equalize, width, preset, max_keypoints, seed)
        _print_next(found, same)
        if report is not None:
            _write_report(found, report)


def _limit(max_keypoints: int) -> Any:
    from aerocues.methods.strongest import KeypointLimit

    return KeypointLimit(max_keypoints)


def _limits(workers: int | None) -> Any:
    from aerocues.evaluation.run import Limits

    return Limits(workers=workers)


def _race(dataset: Dataset, options: RaceOptions, arguments: dict[str, Any]) -> Recommendation:
    from aerocues.cli.interruption import Interrupted
    from aerocues.cli.race_progress import follow
    from aerocues.tuning.recommend import recommend as race

    try:
        with follow(options.budget) as follower:
            return race(dataset, options=options, follower=follower, **arguments)
    except Interrupted as interruption:
        sys.stderr.write("interrupted; run the same command again to go on\n")
        raise typer.Exit(interruption.exit_code) from None


def _print(found: Recommendation, top: int, *, explain: bool) -> None:
    from aerocues.cli.console import print_table, standard_output
    from aerocues.cli.recommendation import answer, ranking, story

    console = standard_output()
    if explain:
        console.print(f"{found.objective.name}: {found.objective.definition}\n", markup=False)
        print_table(console, story(found.outcome))
        console.print()
    console.print(answer(found), soft_wrap=True, markup=False)
    console.print()
    print_table(console, ranking(found, top))
    if found.ranked["excess_inliers"].is_not_null().any():
        console.print("* beyond those that the same matches give when shuffled; medians.")
    console.print(
        "Scores are what is expected of a full measurement; brute force is timed on a part."
    )


def _shrunk(dataset: Dataset, max_width: int) -> int:
    """The width that images were shrunk to; 0 where they are small enough as they are."""
    if not max_width:
        return 0
    width = dataset.images[0].read().bgr.shape[1]
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
