"""`aerocues use`: a combination as a program."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from aerocues.cli.options import EQUALIZE, METHOD_PRESET, MaxWidthOption, PluginOption


class As(StrEnum):
    """Values of ``--as``."""

    PYTHON = "python"
    CPP = "cpp"


def use(
    combination: Annotated[
        str | None,
        typer.Argument(
            metavar="[COMBINATION]",
            help="Such as ORB-BEBLID-HAM-BF; by default the best of --from.",
        ),
    ] = None,
    target: Annotated[As, typer.Option("--as", help="What to use it as.")] = As.PYTHON,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", metavar="FILE", help="File to write; by default standard output."
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
    plugin: PluginOption = None,
) -> None:
    """Use a combination elsewhere: as a program in OpenCV alone.

    The program finds the same keypoints, matches and geometry as were measured, and needs
    nothing but OpenCV.
    """
    import aerocues

    used = aerocues.use(
        combination,
        output,
        target=target.value,
        results=results,
        preset=preset,
        max_keypoints=max_keypoints,
        max_width=max_width,
        equalize=equalize,
        seed=seed,
    )
    if output is None:
        typer.echo(used.text, nl=False)
    else:
        typer.echo(f"{used.combination} written to {output}", err=True)
