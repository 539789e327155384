"""`aerocues reconstruct`: COLMAP models of a scene, once with each of some combinations."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from aerocues.cli.next_commands import AsMeasured
from aerocues.cli.options import (
    EQUALIZE,
    METHOD_PRESET,
    BandOption,
    CombinationsOption,
    EqualFootingOption,
    EveryOption,
    FeaturesWidthOption,
    MaxKeypointsOption,
    MaxWidthOption,
    MemoryLimitOption,
    NoPluginsOption,
    PairsOption,
    PluginOption,
    RefineKeypointsOption,
    RetryFailedOption,
    SeedOption,
    SequencesOption,
    SubsetOption,
    UprightOption,
    WorkersOption,
)
from aerocues.cli.serving import LiveOption
from aerocues.defaults import FLIGHT_KEYPOINTS, STAGE_TIMEOUT

if TYPE_CHECKING:
    from aerocues.reconstruction.models import Models

NOTHING_SUCCEEDED = 1


class Intrinsics(StrEnum):
    """Values of ``--intrinsics``."""

    CALIBRATED = "calibrated"
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
    live: LiveOption = False,
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
    band: BandOption = None,
    every: EveryOption = None,
    sequences: SequencesOption = None,
    max_keypoints: MaxKeypointsOption = FLIGHT_KEYPOINTS,
    max_width: MaxWidthOption = None,
    equalize: Annotated[str | None, EQUALIZE] = None,
    intrinsics: Annotated[
        Intrinsics,
        typer.Option(help="Focal length and distortion: calibrated once, from EXIF, or refined."),
    ] = Intrinsics.CALIBRATED,
    focal_length: Annotated[
        float | None,
        typer.Option(metavar="PIXELS", help="Focal length, in place of the one in EXIF."),
    ] = None,
    mapper: Annotated[Mapper, typer.Option(help="COLMAP mapper.")] = Mapper.INCREMENTAL,
    refine_keypoints: RefineKeypointsOption = None,
    features_width: FeaturesWidthOption = None,
    equal_footing: EqualFootingOption = None,
    reference: Annotated[
        str | None,
        typer.Option(
            metavar="COMBINATION",
            help="Reference of the cloud distances; by default the best model.",
        ),
    ] = None,
    baseline: Annotated[
        bool,
        typer.Option("--baseline/--no-baseline", help="Add COLMAP's default to the table."),
    ] = True,
    preset: Annotated[str | None, METHOD_PRESET] = None,
    upright: UprightOption = False,
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
    timeout: Annotated[
        str, typer.Option(metavar="TIME", help="CPU time limit of one stage, such as 30min.")
    ] = f"{STAGE_TIMEOUT / 60:g}min",
    memory_limit: MemoryLimitOption = None,
    retry_failed: RetryFailedOption = False,
    plugin: PluginOption = None,
    no_plugins: NoPluginsOption = False,
) -> None:
    """Make a COLMAP model of a scene with each chosen combination.

    All combinations get the same pairs, cameras and settings. Each model is saved at once. After
    an interruption run the same command again: it continues. The exit code is 1 if no model in
    the folder succeeded.
    """
    import aerocues
    from aerocues.cli.console import tell_images
    from aerocues.cli.interruption import interruptible
    from aerocues.cli.serving import display_and_page
    from aerocues.modelling.reconstruct import open_as_measured

    measured = None if results is None else aerocues.Results(results)
    with interruptible():
        scene = open_as_measured(
            dataset,
            measured,
            pairs=pairs,
            max_width=max_width,
            equalize=equalize,
            sequences=sequences,
            subset=subset,
            band=band,
            every=every,
        )
        tell_images(scene)
        with display_and_page(results or output, live=live) as (_, progress):
            models = aerocues.reconstruct(
                scene,
                combinations,
                output,
                results=measured,
                top=top,
                preset=preset,
                max_keypoints=max_keypoints,
                intrinsics=intrinsics.value,
                focal_length=focal_length,
                mapper=mapper.value,
                refine_keypoints=refine_keypoints,
                features_width=features_width,
                equal_footing=equal_footing,
                reference=reference,
                baseline=baseline,
                colours=colours,
                undistort=undistort,
                upright=upright,
                seed=seed,
                features=features,
                workers=workers,
                timeout=timeout,
                memory_limit=memory_limit,
                retry_failed=retry_failed,
                progress=progress,
            )
        asked = AsMeasured(
            images=dataset,
            pairs=pairs,
            subset=subset,
            band=band,
            every=every,
            equalize=equalize or "none",
            max_width=max_width or 0,
            preset=preset or "default",
            max_keypoints=max_keypoints,
            seed=seed,
            plugins=tuple(plugin or ()),
            upright=upright,
        )
        succeeded = _print(models, asked, results)
    if not succeeded:
        raise typer.Exit(NOTHING_SUCCEEDED)


def _print(models: Models, asked: AsMeasured, results: Path | None) -> bool:
    """Print models and what to do next; whether any of them is a success."""
    from aerocues.cli.console import standard_output
    from aerocues.cli.model_commands import best_model, model_commands
    from aerocues.cli.models_table import print_models
    from aerocues.reconstruction.exports import PLY

    print_models(models)
    best = best_model(models)
    lines = [f"\nmodels   {models.folder}", f"table    {models.folder / 'reconstructions.csv'}"]
    if best is not None:
        lines.append(f"points   {models.path(best) / PLY}")
    for number, command in enumerate(model_commands(models, best, asked, results)):
        lines.append(f"{'' if number else 'next':9s}{command}")
    for line in lines:
        standard_output().print(line, soft_wrap=True, markup=False)
    return best is not None
