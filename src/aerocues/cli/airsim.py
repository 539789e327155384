"""`aerocues airsim collect`: flies a survey in AirSim, with exact ground truth."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

import typer

from aerocues.cli.options import (
    FieldOfViewOption,
    FlightOption,
    ImageFormatOption,
    SubsetOption,
    SurveyOption,
)
from aerocues.cli.simulate import report_flight
from aerocues.defaults import SIZE

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
    ] = SIZE,
    fov: FieldOfViewOption = 90.0,
    image_format: ImageFormatOption = "png",
    timeout: Annotated[
        float, typer.Option(min=0.1, metavar="SECONDS", help="Longest wait for an answer.")
    ] = 60.0,
) -> None:
    """Fly a survey: images, poses and depth. Continues an interrupted flight."""
    from aerocues.airsim.collect import Collection
    from aerocues.airsim.collect import collect as fly
    from aerocues.cli.interruption import interruptible
    from aerocues.cli.live import display
    from aerocues.simulation.planner import open_survey
    from aerocues.simulation.simulate import two_numbers

    width, height = two_numbers("size", size, "x", SIZE)
    kind = None if flavour is None else flavour.value
    asked = Collection(host, port, kind, int(width), int(height), fov, image_format, timeout)
    with interruptible(), display() as tally:
        fly(output, open_survey(survey, asked.camera), asked, tally, subset)
    report_flight(tally, "collected", "airsim", output)
