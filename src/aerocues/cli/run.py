"""`aerocues run`: measures combinations on the pairs of a dataset."""

from __future__ import annotations

import shlex
import sys
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    import polars as pl

    from aerocues.cli.progress import Tally
    from aerocues.methods.strongest import KeypointLimit
    from aerocues.results.measured_results import Results
    from aerocues.scoring.measured import Measured

MEGABYTES = 1024
# A worker starts with 0.15 GB, and needs 0.3 for the quickest methods on images of 600 pixels.
LEAST_MEMORY = 0.5
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
    dataset: Annotated[
        str,
        typer.Argument(
            metavar="DATASET", help="A folder, or one of the kinds that 'aerocues datasets' lists."
        ),
    ],
    output: Annotated[
        Path,
        typer.Option("-o", "--output", metavar="DIR", help="Results folder: made or continued."),
    ],
    combinations: Annotated[
        str | None, typer.Option(metavar="GLOBS", help="Such as 'ORB-*-HAM-BF,!*-BOOST-*'.")
    ] = None,
    detectors: Annotated[str | None, typer.Option(metavar="GLOBS", help="Keep these.")] = None,
    descriptors: Annotated[str | None, typer.Option(metavar="GLOBS", help="Keep these.")] = None,
    everything: Annotated[
        bool, typer.Option("--all", help="All that can run, not only those that mean something.")
    ] = False,
    preset: Annotated[
        str,
        typer.Option(
            metavar="NAME", help="Parameters: default, thesis, tuned, or a preset's file."
        ),
    ] = "default",
    max_keypoints: Annotated[
        int, typer.Option(min=0, metavar="N", help="Keep the strongest N of an image; 0: all.")
    ] = 0,
    spread: Annotated[
        bool, typer.Option("--spread", help="Keep the strongest of each part of the image.")
    ] = False,
    pairs: Annotated[
        str | None,
        typer.Option(
            metavar="HOW",
            help="consecutive[:K], exhaustive, gps[:K|:50m], overlap:0.3-0.9 or a file of pairs.",
        ),
    ] = None,
    subset: Annotated[
        str | None,
        typer.Option(metavar="GLOBS", help="These images or folders only: 'Layer3/pitch-90_yaw0'."),
    ] = None,
    limit: Annotated[
        int | None, typer.Option(min=1, metavar="N", help="The first N pairs only.")
    ] = None,
    sequences: Annotated[
        str | None, typer.Option(metavar="GLOBS", help="These sequences only, such as 'graf,b*'.")
    ] = None,
    max_width: Annotated[
        int | None,
        typer.Option(metavar="PIXELS", help="Shrink images that are wider; 0: none."),
    ] = None,
    equalize: Annotated[
        str, typer.Option(metavar="HOW", help="Illumination: none, histogram or clahe.")
    ] = "none",
    workers: Annotated[
        int | None, typer.Option(min=1, metavar="N", help="Processes; one a core by default.")
    ] = None,
    engine: Annotated[
        Engine, typer.Option(help="Where: processes on this machine, or a Dask cluster.")
    ] = Engine.LOCAL,
    scheduler: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="Of Dask, such as tcp://host:8786.")
    ] = None,
    resource: Annotated[
        str | None, typer.Option(metavar="NAME", help="Only Dask workers that offer this resource.")
    ] = None,
    timing: Annotated[
        Timing,
        typer.Option(
            help="exclusive: some pairs once more, alone; shared: one pass; estimated: and quicker."
        ),
    ] = Timing.EXCLUSIVE,
    timing_pairs: Annotated[
        int | None,
        typer.Option(
            min=0,
            metavar="K",
            help=f"Pairs that are timed alone; 0: all; {TIMED_PAIRS} by default.",
        ),
    ] = None,
    seed: Annotated[
        int, typer.Option(min=0, max=2**31 - 1, metavar="N", help="Seed of all that is random.")
    ] = 0,
    timeout: Annotated[
        float | None,
        typer.Option(metavar="SECONDS", help="CPU time that one call may use; 600 by default."),
    ] = None,
    memory_limit: Annotated[
        float | None,
        typer.Option(min=LEAST_MEMORY, metavar="GB", help="Memory of a worker; its share of 80 %."),
    ] = None,
    features: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Keep features here, and take what is there."),
    ] = None,
    retry_failed: Annotated[
        bool, typer.Option("--retry-failed", help="Measure again what failed on this machine.")
    ] = False,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Show the plan; measure and write nothing.")
    ] = False,
    top: Annotated[
        int, typer.Option(min=1, metavar="N", help="Length of the table at the end.")
    ] = 15,
) -> None:
    """Measure combinations on the image pairs of a dataset.

    Each result is kept as soon as it is there. Stop at any moment and run the same command again:
    what is finished is not measured twice.
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
    from aerocues.errors import ScoreError
    from aerocues.scoring.measured import table_of
    from aerocues.scoring.ranking import rank_alternatives

    try:
        measured = table_of(rows)
        print_best(rank_alternatives(measured.table, measured.preset.settings), measured, top)
    except ScoreError as error:
        # The rows are there and of use, if only to see why none can be ranked.
        standard_output().print(f"no ranking: {error}", soft_wrap=True, markup=False)
