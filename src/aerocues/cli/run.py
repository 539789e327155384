"""`aerocues run`: measures combinations on the pairs of a dataset."""

from __future__ import annotations

import shlex
import sys
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from aerocues.cli.options import (
    CombinationsOption,
    DatasetArgument,
    DescriptorsOption,
    DetectorsOption,
    EqualizeOption,
    EverythingOption,
    FeaturesOption,
    MaxKeypointsOption,
    MaxWidthOption,
    MemoryLimitOption,
    MethodPresetOption,
    PairsOption,
    PluginOption,
    RetryFailedOption,
    SeedOption,
    SequencesOption,
    SubsetOption,
    TopOption,
    WorkersOption,
)

if TYPE_CHECKING:
    import polars as pl

    from aerocues.cli.progress import Tally
    from aerocues.methods.strongest import KeypointLimit
    from aerocues.results.measured_results import Results
    from aerocues.scoring.measured import Measured

MEGABYTES = 1024
# As `aerocues.evaluation.passes.TIMED_PAIRS`, which takes longer to import than help may take.
TIMED_PAIRS = 5


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
    combinations: CombinationsOption = None,
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
    pairs: PairsOption = None,
    subset: SubsetOption = None,
    limit: Annotated[
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
    seed: SeedOption = 0,
    timeout: Annotated[
        float | None,
        typer.Option(metavar="SECONDS", help="CPU time limit of one call; 600 by default."),
    ] = None,
    memory_limit: MemoryLimitOption = None,
    features: FeaturesOption = None,
    retry_failed: RetryFailedOption = False,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Show the plan without measuring or writing anything.")
    ] = False,
    top: TopOption = 15,
    plugin: PluginOption = None,
) -> None:
    """Measure combinations on the image pairs of a dataset.

    Each result is saved at once. After an interruption run the same command again: it continues,
    and nothing is measured twice.
    """
    from aerocues.cli.cluster import engine_on
    from aerocues.cli.interruption import interruptible
    from aerocues.datasets.catalog import open_dataset

    with interruptible():
        images = open_dataset(
            dataset,
            pairs=pairs,
            max_width=max_width,
            equalize=equalize,
            limit=limit,
            sequences=sequences,
            subset=subset,
        )
        arguments: dict[str, Any] = {
            "dataset": images,
            "combinations": combinations,
            "output": output,
            "detectors": detectors,
            "descriptors": descriptors,
            "everything": everything,
            "preset": preset,
            "seed": seed,
            "timing": timing.value,
            "timed_pairs": _timed_pairs(timing, timing_pairs),
            "limit": _limit(max_keypoints, spread),
            "retry_failed": retry_failed,
        }
        if dry_run:
            from aerocues.cli.dry_run import print_plan

            print_plan(arguments)
            return
        limits = _limits(workers, timeout, memory_limit)
        arguments |= {"limits": limits, "features": features}
        with engine_on(scheduler, resource, limits, dask=engine is Engine.DASK) as chosen:
            results = _measure({**arguments, "engine": chosen})
        _print_results(results, images.name, top)


def _timed_pairs(timing: Timing, asked: int | None) -> int:
    from aerocues.errors import SelectionError

    if asked is not None and timing is not Timing.EXCLUSIVE:
        raise SelectionError(
            f"--timing-pairs is for pairs that are timed alone, and --timing {timing.value} times "
            "none so; leave one of the two out"
        )
    return TIMED_PAIRS if asked is None else asked


def _limit(max_keypoints: int, spread: bool) -> KeypointLimit:
    from aerocues.errors import SelectionError
    from aerocues.methods.strongest import KeypointLimit

    if spread and not max_keypoints:
        raise SelectionError("--spread chooses which keypoints are kept; give --max-keypoints, too")
    return KeypointLimit(max_keypoints, spread)


def _limits(workers: int | None, timeout: float | None, memory_limit: float | None) -> Any:
    from aerocues.evaluation.run import DEFAULT_TIMEOUT, Limits

    return Limits(
        workers=workers,
        timeout=DEFAULT_TIMEOUT if timeout is None else timeout,
        memory_limit_mb=None if memory_limit is None else int(memory_limit * MEGABYTES),
    )


def _measure(arguments: dict[str, Any]) -> Results:
    import aerocues
    from aerocues.cli.interruption import Interrupted
    from aerocues.cli.live import display

    tally: Tally | None = None
    try:
        with display() as tally:
            results = aerocues.run(**arguments, observer=tally)
    except Interrupted as interruption:
        stored = f"; {tally.stored()}" if tally and tally.plan else ""
        sys.stderr.write(f"interrupted{stored}; run the same command again to go on\n")
        raise typer.Exit(interruption.exit_code) from None
    _report_end(tally)
    return results


def _report_end(tally: Tally) -> None:
    from aerocues.cli.progress import spoken_seconds

    if tally.rows_measured_in_all:
        line = f"{tally.measured()} in {spoken_seconds(tally.elapsed_in_all)}"
    elif tally.rows_stored:
        line = f"nothing to measure: {tally.there_already()}"
    else:
        line = "nothing to measure: the images rule out all combinations that were chosen"
    sys.stderr.write(f"{line}\n\n")


def _print_results(results: Results, dataset: str, top: int) -> None:
    import polars as pl

    from aerocues.cli.cluster import machine_lines
    from aerocues.cli.console import standard_output
    from aerocues.cli.status import times_of
    from aerocues.results.measured_results import timing_counts
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
