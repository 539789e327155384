"""`aerocues simulate`: flies a survey over an artificial scene, with exact ground truth."""

from __future__ import annotations

import shlex
from typing import TYPE_CHECKING, Annotated

import typer

from aerocues.cli.options import (
    FieldOfViewOption,
    FlightOption,
    ImageFormatOption,
    SeedOption,
    SubsetOption,
    SurveyOption,
)
from aerocues.defaults import SIZE, SUN
from aerocues.phrases import count

if TYPE_CHECKING:
    from pathlib import Path

    from aerocues.cli.progress import Tally


def simulate(
    output: FlightOption,
    survey: SurveyOption = "mini",
    subset: SubsetOption = None,
    scene: Annotated[
        str,
        typer.Option(metavar="NAME", help="Scene: suburb, fields or industrial."),
    ] = "suburb",
    seed: SeedOption = 0,
    size: Annotated[str, typer.Option(metavar="WxH", help="Image size in pixels.")] = SIZE,
    fov: FieldOfViewOption = 90.0,
    sun: Annotated[
        str,
        typer.Option(
            metavar="AZ,EL",
            help="Position of the sun: azimuth from north and elevation, in degrees.",
        ),
    ] = SUN,
    haze: Annotated[
        float, typer.Option(min=0.0, metavar="AMOUNT", help="Haze; 0: clear air.")
    ] = 0.2,
    glints: Annotated[
        float,
        typer.Option(
            min=0.0,
            metavar="AMOUNT",
            help="How much leaves and roofs change with the viewing direction.",
        ),
    ] = 1.0,
    noise: Annotated[
        float, typer.Option(min=0.0, metavar="AMOUNT", help="Sensor noise; 0: none.")
    ] = 1.0,
    blur: Annotated[
        float, typer.Option(min=0.0, metavar="PIXELS", help="Lens blur in pixels.")
    ] = 0.55,
    motion: Annotated[
        float, typer.Option(min=0.0, metavar="PIXELS", help="Motion blur in pixels.")
    ] = 0.0,
    exposure_jitter: Annotated[
        float,
        typer.Option(min=0.0, metavar="STOPS", help="Exposure changes between images, in stops."),
    ] = 0.0,
    interval: Annotated[
        float,
        typer.Option(min=0.0, metavar="SECONDS", help="Time between images, in which cars move."),
    ] = 0.0,
    wind: Annotated[
        float,
        typer.Option(
            "--wind",
            "--wind-trees",
            min=0.0,
            metavar="METRES",
            help="How far the wind moves tree crowns between images; needs --interval.",
        ),
    ] = 0.0,
    image_format: ImageFormatOption = "png",
) -> None:
    """Simulate a survey flight: images, poses and depth. Continues an interrupted flight."""
    from aerocues.cli.interruption import interruptible
    from aerocues.cli.live import display
    from aerocues.simulation.simulate import fly_survey

    with interruptible(), display() as tally:
        fly_survey(
            survey,
            output,
            scene=scene,
            subset=subset,
            seed=seed,
            size=size,
            fov=fov,
            sun=sun,
            haze=haze,
            glints=glints,
            noise=noise,
            blur=blur,
            motion=motion,
            exposure_jitter=exposure_jitter,
            interval=interval,
            wind=wind,
            image_format=image_format,
            progress=tally,
        )
    report_flight(tally, "rendered", "simulated", output)


def report_flight(tally: Tally, made: str, kind: str, folder: Path) -> None:
    """Print what was made, and what to do with it."""
    (images,) = tally.counted
    kept = f", {images.first} kept" if images.first else ""
    typer.echo(
        f"{count(images.added, 'image')} {made}{kept} in {folder}; "
        f"measure them with: aerocues run {kind}:{shlex.quote(str(folder))}"
    )
