"""`aerocues airsim collect`: flies a survey in AirSim, with exact ground truth."""

from __future__ import annotations

import shlex
from enum import StrEnum
from typing import Annotated

import typer

from aerocues.cli.console import count
from aerocues.cli.options import (
    FieldOfViewOption,
    FlightOption,
    ImageFormatOption,
    SubsetOption,
    SurveyOption,
)
from aerocues.cli.simulate import numbers

app = typer.Typer(help="Collect images from a running AirSim.", no_args_is_help=True)


class Flavour(StrEnum):
    """Values of ``--flavour``."""

    AIRSIM = "airsim"
    COSYS = "cosys"


@app.callback()
def airsim() -> None:
    """Collect images from AirSim or Cosys-AirSim, which runs in ComputerVision mode."""


@app.command()
def collect(
    output: FlightOption,
    survey: SurveyOption = "airsimnh",
    subset: SubsetOption = None,
    host: Annotated[str, typer.Option(metavar="NAME", help="Host of the simulator.")] = "127.0.0.1",
    port: Annotated[
        int, typer.Option(min=1, max=65535, metavar="N", help="Port of the simulator.")
    ] = 41451,
    flavour: Annotated[
        Flavour | None, typer.Option(help="airsim (1.8.1) or cosys; detected by default.")
    ] = None,
    size: Annotated[
        str,
        typer.Option(
            metavar="WxH", help="Image size in pixels, as in the simulator's settings.json."
        ),
    ] = "1000x665",
    fov: FieldOfViewOption = 90.0,
    form: ImageFormatOption = "png",
    timeout: Annotated[
        float, typer.Option(min=0.1, metavar="SECONDS", help="Longest wait for an answer.")
    ] = 60.0,
) -> None:
    """Fly a survey: images, poses and depth. Continues an interrupted flight."""
    from aerocues.airsim.collect import Collection
    from aerocues.airsim.collect import collect as fly
    from aerocues.cli.flying import show
    from aerocues.simulation.flight import shots_in
    from aerocues.simulation.planner import open_survey

    width, height = numbers(size, "x", "--size", "1000x665")
    kind = None if flavour is None else flavour.value
    asked = Collection(host, port, kind, int(width), int(height), fov, form, timeout)
    chosen = open_survey(survey, asked.camera)
    flown = show(
        f"{asked.address}, {chosen.name}",
        len(shots_in(chosen, subset, form)),
        lambda tell: fly(output, chosen, asked, tell, subset),
    )
    kept = f", {flown.kept} kept" if flown.kept else ""
    typer.echo(
        f"{count(flown.rendered, 'image')} collected{kept} in {output}; "
        f"measure them with: aerocues run airsim:{shlex.quote(str(output))}"
    )
