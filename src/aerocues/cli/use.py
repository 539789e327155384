"""`aerocues use`: a combination as a program, or in files of another tool."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from aerocues.cli.options import (
    EQUALIZE,
    METHOD_PRESET,
    FeaturesOption,
    FeaturesWidthOption,
    MaxWidthOption,
    MemoryLimitOption,
    PairsOption,
    PluginOption,
    RefineKeypointsOption,
    SubsetOption,
    UprightOption,
)
from aerocues.defaults import STAGE_TIMEOUT

if TYPE_CHECKING:
    from aerocues.exports.use import Used

NAME_PARTS = 4


class As(StrEnum):
    """Values of ``--as``."""

    PYTHON = "python"
    CPP = "cpp"
    COLMAP = "colmap"
    HLOC = "hloc"
    OPENSFM = "opensfm"
    ODM = "odm"
    OPENMVG = "openmvg"
    BUNDLER = "bundler"
    KAPTURE = "kapture"
    RTABMAP = "rtabmap"
    ODM_OPTIONS = "odm-options"


def use(
    combination: Annotated[
        str | None,
        typer.Argument(
            metavar="[COMBINATION]",
            help="Such as ORB-BEBLID-HAM-BF; by default the best of --from.",
        ),
    ] = None,
    dataset: Annotated[
        str | None,
        typer.Argument(
            metavar="[IMAGES]", help="A folder of images, for files; by default those of --from."
        ),
    ] = None,
    target: Annotated[As, typer.Option("--as", help="What to use it as.")] = As.PYTHON,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="PATH",
            help="File of a program or settings (by default standard output), or folder.",
        ),
    ] = None,
    results: Annotated[
        Path | None,
        typer.Option(
            "--from",
            metavar="RESULTS",
            help="Use the best combination of these results, exactly as it was measured.",
        ),
    ] = None,
    preset: Annotated[str | None, METHOD_PRESET] = None,
    max_keypoints: Annotated[
        int | None,
        typer.Option(
            min=0, metavar="N", help="Keep the N strongest keypoints of each image; 0 keeps all."
        ),
    ] = None,
    max_width: MaxWidthOption = None,
    equalize: Annotated[str | None, EQUALIZE] = None,
    seed: Annotated[
        int | None,
        typer.Option(min=0, max=2**31 - 1, metavar="N", help="Seed of all random choices."),
    ] = None,
    pairs: PairsOption = None,
    subset: SubsetOption = None,
    upright: UprightOption = False,
    refine_keypoints: RefineKeypointsOption = None,
    features_width: FeaturesWidthOption = None,
    features: FeaturesOption = None,
    timeout: Annotated[
        str, typer.Option(metavar="TIME", help="CPU time limit of one stage, such as 30min.")
    ] = f"{STAGE_TIMEOUT / 60:g}min",
    memory_limit: MemoryLimitOption = None,
    plugin: PluginOption = None,
) -> None:
    """Use a combination: as a program, or in another tool.

    A program (python, cpp) finds the same keypoints, matches and geometry as were measured, and
    needs nothing but OpenCV. Files hold the features, matches and verified pairs of a whole flight;
    the tool goes on from them. Settings (rtabmap, odm-options) are the nearest that a tool with a
    fixed list of features has.
    """
    import aerocues
    from aerocues.cli.interruption import interruptible
    from aerocues.cli.live import display

    if results is not None and dataset is None and combination and not _is_name(combination):
        combination, dataset = None, combination
    with interruptible(), display() as tally:
        used = aerocues.use(
            dataset,
            combination,
            output,
            target=target.value,
            results=results,
            preset=preset,
            max_keypoints=max_keypoints,
            max_width=max_width,
            equalize=equalize,
            seed=seed,
            pairs=pairs,
            subset=subset,
            upright=upright,
            refine_keypoints=refine_keypoints,
            features_width=features_width,
            features=features,
            timeout=timeout,
            memory_limit=memory_limit,
            progress=tally,
        )
    _print(used)


def _is_name(word: str) -> bool:
    """Whether a word names a combination rather than images."""
    from aerocues.methods.plugins import installed_methods

    if Path(word).exists():
        return False
    return len(word.split("-")) == NAME_PARTS or word.upper() in installed_methods().pair_matchers


def _print(used: Used) -> None:
    if used.path is None:
        typer.echo(used.text, nl=False)
        return
    typer.echo(f"{used.combination} for {used.target}: {used.path}")
    if used.figures:
        typer.echo(f"\n{used}\n")
    for number, command in enumerate(used.next):
        typer.echo(f"{'' if number else 'next':9s}{command}")
