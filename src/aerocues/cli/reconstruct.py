"""`aerocues reconstruct`: COLMAP models of a scene, once with each of some combinations."""

from __future__ import annotations

import shlex
import sys
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from aerocues.cli.options import (
    EQUALIZE,
    METHOD_PRESET,
    CombinationsOption,
    MaxKeypointsOption,
    MaxWidthOption,
    MemoryLimitOption,
    PairsOption,
    PluginOption,
    RetryFailedOption,
    SeedOption,
    SequencesOption,
    SubsetOption,
    WorkersOption,
)

if TYPE_CHECKING:
    from aerocues.cli.reconstruction_progress import Reporter
    from aerocues.datasets.dataset import Dataset
    from aerocues.reconstruction.models import Models
    from aerocues.reconstruction.options import ReconstructionOptions

MEGABYTES = 1024
NOTHING_SUCCEEDED = 1


class Intrinsics(StrEnum):
    """Values of ``--intrinsics``."""

    FIXED = "fixed"
    REFINE = "refine"


class Mapper(StrEnum):
    """Values of ``--mapper``."""

    INCREMENTAL = "incremental"
    GLOBAL = "global"


def reconstruct(
    dataset: Annotated[
        str, typer.Argument(metavar="DATASET", help="A folder of images, flight:DIR or uav:DIR.")
    ],
    output: Annotated[
        Path,
        typer.Option(
            "-o", "--output", metavar="MODELS", help="Folder of the models, created or continued."
        ),
    ],
    combinations: CombinationsOption = None,
    results: Annotated[
        Path | None,
        typer.Option(
            "--from",
            metavar="RESULTS",
            help="Use the best combinations of these results, and add the figures to them.",
        ),
    ] = None,
    top: Annotated[
        int | None,
        typer.Option(
            min=1, metavar="N", help="Number of best combinations of --from; 10 by default."
        ),
    ] = None,
    pairs: PairsOption = None,
    subset: SubsetOption = None,
    sequences: SequencesOption = None,
    max_keypoints: MaxKeypointsOption = 8000,
    max_width: MaxWidthOption = None,
    equalize: Annotated[str | None, EQUALIZE] = None,
    intrinsics: Annotated[
        Intrinsics, typer.Option(help="Keep or refine focal length and distortion.")
    ] = Intrinsics.FIXED,
    focal_length: Annotated[
        float | None,
        typer.Option(metavar="PIXELS", help="Focal length, in place of the one in EXIF."),
    ] = None,
    mapper: Annotated[Mapper, typer.Option(help="COLMAP mapper.")] = Mapper.INCREMENTAL,
    reference: Annotated[
        str | None,
        typer.Option(
            metavar="COMBINATION",
            help="Reference of the cloud distances; by default the largest model.",
        ),
    ] = None,
    preset: Annotated[str | None, METHOD_PRESET] = None,
    seed: SeedOption = 0,
    colours: Annotated[
        bool, typer.Option("--colours/--no-colours", help="Colour the points.")
    ] = True,
    undistort: Annotated[
        bool,
        typer.Option("--undistort", help="Also write undistorted images for dense reconstruction."),
    ] = False,
    features: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR",
            help="Folder of features, reused and extended; by default the one of --from.",
        ),
    ] = None,
    workers: WorkersOption = None,
    time_limit: Annotated[
        float, typer.Option(min=0.001, metavar="SECONDS", help="CPU time limit of one stage.")
    ] = 1800.0,
    memory_limit: MemoryLimitOption = None,
    retry_failed: RetryFailedOption = False,
    plugin: PluginOption = None,
) -> None:
    """Make a COLMAP model of a scene with each chosen combination.

    All combinations get the same pairs, cameras and settings. Each model is saved at once. After
    an interruption run the same command again: it continues. The exit code is 1 if no model in
    the folder succeeded.
    """
    from aerocues.cli.interruption import interruptible
    from aerocues.errors import ReconstructionError
    from aerocues.modelling import open_as_measured, preset_of_results

    if combinations is not None and top is not None:
        raise ReconstructionError("--top chooses out of --from; leave it or --combinations out")
    with interruptible():
        scene = open_as_measured(
            dataset,
            results,
            pairs=pairs,
            max_width=max_width,
            equalize=equalize,
            sequences=sequences,
            subset=subset,
        )
        options = _options(
            {
                "max_keypoints": max_keypoints,
                "intrinsics": intrinsics.value,
                "focal_length": focal_length,
                "mapper": mapper.value,
                "seed": seed,
            },
            colours=colours,
            undistorted=undistort,
            preset=preset or preset_of_results(results),
            reference=reference,
            features=features,
            workers=workers,
            time_limit=time_limit,
            memory_limit_mb=None if memory_limit is None else int(memory_limit * MEGABYTES),
            retry_failed=retry_failed,
        )
        models = _reconstruct(scene, output, combinations, results, top, options)
        succeeded = _print(models, dataset, results)
    if not succeeded:
        raise typer.Exit(NOTHING_SUCCEEDED)


def _options(
    protocol: dict[str, Any], *, colours: bool, undistorted: bool, **others: Any
) -> ReconstructionOptions:
    from aerocues.reconstruction.options import ReconstructionOptions
    from aerocues.reconstruction.protocol import ReconstructionProtocol
    from aerocues.reconstruction.scene import Wanted

    return ReconstructionOptions(
        protocol=ReconstructionProtocol(**protocol), wanted=Wanted(colours, undistorted), **others
    )


def _reconstruct(
    scene: Dataset,
    output: Path,
    combinations: str | None,
    results: Path | None,
    top: int | None,
    options: ReconstructionOptions,
) -> Models:
    from aerocues.cli.interruption import Interrupted
    from aerocues.cli.reconstruction_progress import reporter
    from aerocues.modelling import reconstruct as make

    shown: Reporter | None = None
    try:
        with reporter() as shown:
            return make(
                scene,
                output,
                combinations,
                results=results,
                top=top,
                options=options,
                observer=shown,
            )
    except Interrupted as interruption:
        kept = f"; {shown.done} of {shown.total} are finished" if shown and shown.total else ""
        sys.stderr.write(f"interrupted{kept}; run the same command again to go on\n")
        raise typer.Exit(interruption.exit_code) from None


def _print(models: Models, dataset: str, results: Path | None) -> bool:
    """Print models and what to do next; whether any of them is a success."""
    from aerocues.cli.console import standard_output
    from aerocues.cli.models_table import print_models

    print_models(models)
    succeeded = "ok" in models.table()["status"]
    console = standard_output()
    for line in (
        f"\nmodels   {models.folder}",
        f"table    {models.folder / 'reconstructions.csv'}",
        *_next(models, dataset, results, succeeded=succeeded),
    ):
        console.print(line, soft_wrap=True, markup=False)
    return succeeded


def _next(models: Models, dataset: str, results: Path | None, *, succeeded: bool) -> list[str]:
    """What to do next; nothing that needs a success where there is none."""
    if results is None and succeeded:
        folder = shlex.quote(str(models.folder))
        return [f"next     colmap gui --import_path {folder}/COMBINATION/sparse/0"]
    if results is None:
        named = shlex.quote(dataset)
        return [f"next     aerocues recommend {named} --objective reconstruction"]
    named = shlex.quote(str(results))
    commands = [f"aerocues score {named} --reconstruction"] if succeeded else []
    commands.append(f"aerocues report {named}")
    return [f"{'next' if not i else '':9s}{command}" for i, command in enumerate(commands)]
