"""`aerocues run`: measures combinations on the pairs of a dataset."""

from __future__ import annotations

import shlex
import sys
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from aerocues.cli.options import (
    BandOption,
    CombinationsOption,
    DatasetArgument,
    DescriptorsOption,
    DetectorsOption,
    EqualizeOption,
    EveryOption,
    EverythingOption,
    FeaturesOption,
    MaxKeypointsOption,
    MaxWidthOption,
    MemoryLimitOption,
    MethodPresetOption,
    NoPluginsOption,
    PairsOption,
    PluginOption,
    RetryFailedOption,
    SeedOption,
    SequencesOption,
    SubsetOption,
    TopOption,
    UprightOption,
    WithOption,
    WorkersOption,
    with_sets,
)
from aerocues.cli.serving import LiveOption
from aerocues.defaults import CALL_TIMEOUT, TIMED_PAIRS

if TYPE_CHECKING:
    import polars as pl

    from aerocues.cli.progress import Tally
    from aerocues.results.measured_results import Results
    from aerocues.scoring.measured import Measured


NOTHING_MEASURED = 1


class Engine(StrEnum):
    """Values of ``--engine``."""

    LOCAL = "local"
    DASK = "dask"


class Timing(StrEnum):
    """Values of ``--timing``."""

    EXCLUSIVE = "exclusive"
    SHARED = "shared"
    ESTIMATED = "estimated"


def run(
    dataset: DatasetArgument,
    output: Annotated[
        Path,
        typer.Option("-o", "--output", metavar="DIR", help="Results folder, created or continued."),
    ],
    live: LiveOption = False,
    combinations: CombinationsOption = None,
    sets: WithOption = None,
    detectors: DetectorsOption = None,
    descriptors: DescriptorsOption = None,
    everything: EverythingOption = False,
    preset: MethodPresetOption = "default",
    max_keypoints: MaxKeypointsOption = 0,
    spread: Annotated[
        bool,
        typer.Option(
            "--spread", help="With --max-keypoints: spread them over the parts of the image."
        ),
    ] = False,
    equal_footing: Annotated[
        bool | None,
        typer.Option(
            "--equal-footing/--no-equal-footing",
            help="Lower thresholds of detectors until they find --max-keypoints; default: only for "
            "tuned.",
        ),
    ] = None,
    pairs: PairsOption = None,
    subset: SubsetOption = None,
    band: BandOption = None,
    every: EveryOption = None,
    max_pairs: Annotated[
        int | None, typer.Option(min=1, metavar="N", help="Use only the first N pairs.")
    ] = None,
    sequences: SequencesOption = None,
    max_width: MaxWidthOption = None,
    equalize: EqualizeOption = "none",
    workers: WorkersOption = None,
    engine: Annotated[
        Engine, typer.Option(help="Run on this machine (local) or on a Dask cluster (dask).")
    ] = Engine.LOCAL,
    scheduler: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS", help="Address of the Dask scheduler, such as tcp://host:8786."
        ),
    ] = None,
    resource: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="Use only Dask workers that offer this resource."),
    ] = None,
    timing: Annotated[
        Timing,
        typer.Option(
            help="exclusive: measure some pairs again, one call at a time; shared: one pass; "
            "estimated: one pass with fast exact matching."
        ),
    ] = Timing.EXCLUSIVE,
    timing_pairs: Annotated[
        int | None,
        typer.Option(
            min=0,
            metavar="K",
            help=f"Pairs to time alone; {TIMED_PAIRS} by default, 0: all.",
        ),
    ] = None,
    upright: UprightOption = False,
    seed: SeedOption = 0,
    timeout: Annotated[
        str, typer.Option(metavar="TIME", help="CPU time limit of one call, such as 90s or 10min.")
    ] = f"{CALL_TIMEOUT:g}s",
    memory_limit: MemoryLimitOption = None,
    features: FeaturesOption = None,
    retry_failed: RetryFailedOption = False,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Show the plan without measuring or writing anything.")
    ] = False,
    top: TopOption = 15,
    plugin: PluginOption = None,
    no_plugins: NoPluginsOption = False,
) -> None:
    """Measure combinations on the image pairs of a dataset.

    Without --pairs, a flight or folder is surveyed: about 24 pairs stand for it and hold every
    image. Each result is saved at once. After an interruption run the same command again: it
    continues, and nothing is measured twice. The exit code is 1 if every row is an error.
    """
    from aerocues.cli.cluster import engine_on
    from aerocues.cli.console import tell_images
    from aerocues.cli.interruption import interruptible
    from aerocues.datasets.catalog import open_dataset

    with interruptible():
        images = open_dataset(
            dataset,
            pairs=pairs,
            max_width=max_width,
            equalize=equalize,
            max_pairs=max_pairs,
            sequences=sequences,
            subset=subset,
            band=band,
            every=every,
        )
        tell_images(images)
        arguments: dict[str, Any] = {
            "dataset": images,
            "combinations": with_sets(combinations, sets),
            "output": output,
            "detectors": detectors,
            "descriptors": descriptors,
            "everything": everything,
            "preset": preset,
            "max_keypoints": max_keypoints,
            "spread": spread,
            "equal_footing": equal_footing,
            "seed": seed,
            "timing": timing.value,
            "timing_pairs": timing_pairs,
            "upright": upright,
            "retry_failed": retry_failed,
        }
        if dry_run:
            from aerocues.cli.dry_run import print_plan

            print_plan(arguments)
            return
        limits = {"workers": workers, "timeout": timeout, "memory_limit": memory_limit}
        arguments |= {**limits, "features": features}
        with engine_on(scheduler, resource, limits, dask=engine is Engine.DASK) as chosen:
            results = _measure({**arguments, "engine": chosen}, live=live)
        measured = _print_results(results, images.name, top)
    if not measured:
        raise typer.Exit(NOTHING_MEASURED)


def _measure(arguments: dict[str, Any], *, live: bool) -> Results:
    import aerocues
    from aerocues.cli.serving import display_and_page

    with display_and_page(arguments["output"], live=live) as (tally, progress):
        results = aerocues.run(**arguments, progress=progress)
    sys.stderr.write(f"{_end(tally)}\n\n")
    return results


def _end(tally: Tally) -> str:
    """What was measured, and how long that took."""
    from aerocues.phrases import count, spoken_seconds

    measured, timed = (
        tally.stages[stage].added if stage in tally.stages else 0
        for stage in ("measuring", "timing")
    )
    told = [f"measured {count(measured, 'row')}"] if measured else []
    told += [f"timed {timed:,} alone"] if timed else []
    if told:
        return f"{' and '.join(told)} in {spoken_seconds(tally.elapsed)}"
    if there := max((each.done for each in tally.counted), default=0):
        return f"nothing to measure: all {count(there, 'row')} are there already"
    return "nothing to measure: the images rule out all combinations that were chosen"


def _print_results(results: Results, dataset: str, top: int) -> bool:
    """Print the best and what to do next; whether anything could be measured."""
    import polars as pl

    from aerocues.cli.cluster import machine_lines
    from aerocues.cli.console import standard_output
    from aerocues.cli.status import times_of
    from aerocues.results.measured_results import timing_counts
    from aerocues.results.statuses import RETRIED
    from aerocues.scoring.measured import MeasuredRows

    table = results.table().filter(pl.col("dataset") == dataset)
    if len(table):
        _print_ranking(MeasuredRows(table, results.reconstructions()), top)
    console = standard_output()
    counts = table["status"].value_counts(sort=True).iter_rows()
    by_status = ", ".join(f"{status} {number:,}" for status, number in counts) or "none"
    folder = shlex.quote(str(results.folder))
    timings, disturbed = timing_counts(table)
    for line in (
        f"\nrows     {len(table):,}: {by_status}",
        *machine_lines(table),
        f"times    {times_of(timings, disturbed)}",
        f"results  {results.folder}",
        f"next     aerocues status {folder}",
        *(f"         aerocues {what}" for what in _next(folder, table)),
    ):
        console.print(line, soft_wrap=True, markup=False)
    return not len(table) or not table["status"].is_in(RETRIED).all()


def _next(folder: str, table: pl.DataFrame) -> tuple[str, ...]:
    """What the rows are good for; where none succeeded, there is nothing to rank."""
    rows = f"results {folder} --csv rows.csv"
    ranked = (f"score {folder}", f"report {folder}") if (table["status"] == "ok").any() else ()
    return (*ranked, rows)


def _print_ranking(rows: Measured, top: int) -> None:
    from aerocues.cli.console import standard_output
    from aerocues.cli.ranking_table import print_best
    from aerocues.cli.wording import in_options
    from aerocues.errors import ScoreError
    from aerocues.scoring.measured import table_of
    from aerocues.scoring.ranking import rank_alternatives

    try:
        measured = table_of(rows)
        print_best(rank_alternatives(measured.table, measured.preset.settings), measured, top)
    except ScoreError as error:
        # The rows are there and of use, if only to see why none can be ranked.
        told = in_options(str(error))
        standard_output().print(f"no ranking: {told}", soft_wrap=True, markup=False)
