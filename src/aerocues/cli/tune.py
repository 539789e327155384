"""`aerocues tune`: finds parameters of methods, and writes them as a preset."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from aerocues.cli.options import (
    MaxKeypointsOption,
    MaxWidthOption,
    NoPluginsOption,
    PairsOption,
    PluginOption,
    SeedOption,
    WorkersOption,
)
from aerocues.defaults import TUNING_PAIRS

if TYPE_CHECKING:
    from rich.table import Table

    from aerocues.datasets.dataset import Dataset
    from aerocues.tuning.search import Finding
    from aerocues.tuning.tune import Tuned


def tune(
    methods: Annotated[
        str,
        typer.Argument(
            metavar="METHODS",
            help="Methods (LATCH, detector:ORB) or combinations, separated by commas, or 'all'.",
        ),
    ],
    datasets: Annotated[
        list[str], typer.Argument(metavar="DATASET...", help="Folders or kinds of datasets.")
    ],
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="FILE", help="Preset file to write (JSON).")
    ],
    validation: Annotated[
        list[str] | None,
        typer.Option(
            "--validate",
            metavar="DATASET",
            help="Validate on this dataset; by default on held-out scenes.",
        ),
    ] = None,
    grid: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help='JSON file of values to try, such as {"threshold": [5, 10, 20]}.'
        ),
    ] = None,
    objective: Annotated[
        str,
        typer.Option(
            metavar="CRITERION", help="Objective: cues, or a criterion such as excess_inliers."
        ),
    ] = "cues",
    budget: Annotated[
        str | None,
        typer.Option(metavar="TIME", help="Time limit of this call, such as 30min."),
    ] = None,
    max_keypoints: MaxKeypointsOption = 0,
    pairs: PairsOption = None,
    max_pairs: Annotated[
        int,
        typer.Option(min=3, metavar="N", help="Number of training pairs, and of validation pairs."),
    ] = TUNING_PAIRS,
    max_width: MaxWidthOption = None,
    results: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Folder of the measurements; by default FILE-search."),
    ] = None,
    workers: WorkersOption = None,
    seed: SeedOption = 0,
    plugin: PluginOption = None,
    no_plugins: NoPluginsOption = False,
) -> None:
    """Search parameters on some scenes and keep those that also help on other scenes.

    After an interruption run the same command again: it continues.
    """
    from aerocues.cli.interruption import interruptible
    from aerocues.cli.live import display
    from aerocues.tuning.tune import tune as search

    with interruptible():
        opened, others = (
            [_opened(spec, pairs, max_width) for spec in specs or ()]
            for specs in (datasets, validation)
        )
        with display() as tally:
            tuned = search(
                opened,
                methods,
                output,
                validation=others,
                grid=grid,
                objective=objective,
                max_pairs=max_pairs,
                max_keypoints=max_keypoints,
                budget=budget,
                seed=seed,
                results=results,
                workers=workers,
                progress=tally,
            )
    _print(tuned, output, datasets)


def _opened(spec: str, pairs: str | None, max_width: int | None) -> Dataset:
    """A dataset; `pairs` is for those that leave them open."""
    from aerocues.datasets.catalog import open_dataset, takes_pairs

    return open_dataset(spec, pairs=pairs if takes_pairs(spec) else None, max_width=max_width)


def _print(tuned: Tuned, output: Path, datasets: list[str]) -> None:
    from aerocues.cli.console import print_table, standard_output
    from aerocues.phrases import count

    console = standard_output()
    training = sum(len(split.training) for split in tuned.splits)
    validation = sum(len(split.validation) for split in tuned.splits)
    ways = ", ".join(dict.fromkeys(split.by for split in tuned.splits))
    console.print(
        f"{count(len(tuned.findings), 'setting')}: chosen by {training} pairs, judged "
        f"by {validation} others, divided by {ways}",
        markup=False,
        soft_wrap=True,
    )
    print_table(console, table(tuned.findings))
    for line in (
        "gain: of the score on the pairs to judge by, at least: the low end of its 95 % interval;",
        f"figures: means{_scenes_told(tuned.findings)}",
        f"\npreset   {output}",
        f"search   {tuned.folder}",
        f"next     aerocues run {shlex.quote(datasets[0])} -o results --preset "
        f"{shlex.quote(str(output))}",
    ):
        console.print(line, soft_wrap=True, markup=False)


def _scenes_told(findings: list[Finding]) -> str:
    """What too few scenes to judge by mean for the intervals."""
    from aerocues.phrases import count
    from aerocues.tuning.search_objective import FEWEST_SCENES

    scenes = max((each.judged_by.scenes for each in findings if each.judged_by), default=0)
    if not 0 < scenes < FEWEST_SCENES:
        return ""
    return f"; intervals tell of {count(scenes, 'scene')} only: judge on {FEWEST_SCENES} or more"


def table(findings: list[Finding]) -> Table:
    """A row a search."""
    from aerocues.cli.console import plain_table
    from aerocues.tuning.search_progress import setting_text

    headings = ("gain", "at least", "inliers", "right matches", "share right")
    output = plain_table("searched", "best", "kept", *headings, numbers=len(headings))
    output.columns[0].no_wrap = True
    for finding in findings:
        default, tuned = finding.default, finding.tuned
        figures = ["-"] * len(headings)
        if default is not None and tuned is not None:
            figures = [
                f"{finding.gain:+.3f}",
                f"{finding.low:+.3f}",
                _change(default.inliers, tuned.inliers, ",.0f"),
                _change(default.right_matches, tuned.right_matches, ",.0f"),
                _change(default.right_share, tuned.right_share, ".2f"),
            ]
        kept = "yes" if finding.pays else "no"
        output.add_row(finding.space.name, setting_text(finding.best), kept, *figures)
    return output


def _change(before: float | None, after: float | None, form: str) -> str:
    if before is None or after is None:
        return "-"
    return f"{before:{form}} > {after:{form}}"
