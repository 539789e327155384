"""`aerocues simulate`: flies a survey over an artificial scene, with exact ground truth."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from aerocues.cli.console import count
from aerocues.cli.options import (
    FieldOfViewOption,
    FlightOption,
    ImageFormatOption,
    SeedOption,
    SubsetOption,
    SurveyOption,
)

if TYPE_CHECKING:
    from aerocues.simulation.flight import Settings


def simulate(
    output: FlightOption,
    survey: SurveyOption = "mini",
    subset: SubsetOption = None,
    scene: Annotated[
        str,
        typer.Option(metavar="NAME", help="Scene: suburb, fields or industrial."),
    ] = "suburb",
    seed: SeedOption = 0,
    size: Annotated[str, typer.Option(metavar="WxH", help="Image size in pixels.")] = "1000x665",
    fov: FieldOfViewOption = 90.0,
    sun: Annotated[
        str,
        typer.Option(
            metavar="AZ,EL",
            help="Position of the sun: azimuth from north and elevation, in degrees.",
        ),
    ] = "140,48",
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
    form: ImageFormatOption = "png",
) -> None:
    """Simulate a survey flight: images, poses and depth. Continues an interrupted flight."""
    from aerocues.simulation.flight import Settings
    from aerocues.simulation.lighting import Weather
    from aerocues.simulation.sensor import Sensor

    width, height = numbers(size, "x", "--size", "1000x665")
    azimuth, elevation = numbers(sun, ",", "--sun", "140,48")
    settings = Settings(
        scene=scene,
        seed=seed,
        width=int(width),
        height=int(height),
        fov=fov,
        weather=Weather(azimuth, elevation, haze, glints),
        sensor=Sensor(noise, blur, motion, exposure_jitter=exposure_jitter),
        interval=interval,
        wind=wind,
        form=form,
    )
    _fly(output, survey, settings, subset)


def _fly(folder: Path, spec: str, settings: Settings, subset: str | None) -> None:
    from aerocues.cli.flying import show
    from aerocues.simulation.flight import shots_in
    from aerocues.simulation.flight import simulate as fly
    from aerocues.simulation.planner import open_survey

    survey = open_survey(spec, settings.camera)
    total = len(shots_in(survey, subset, settings.form))
    flown = show(
        f"{settings.scene}, {survey.name}",
        total,
        lambda tell: fly(folder, survey, settings, tell, subset),
    )
    kept = f", {flown.kept} kept" if flown.kept else ""
    typer.echo(
        f"{count(flown.rendered, 'image')} rendered{kept} in {folder}; "
        f"measure them with: aerocues run simulated:{shlex.quote(str(folder))}"
    )


def numbers(text: str, mark: str, option: str, example: str) -> tuple[float, float]:
    """The two numbers of an option, which `mark` separates."""
    try:
        first, second = (float(part) for part in text.lower().split(mark))
    except ValueError as error:
        raise typer.BadParameter(f"{option} must be like {example}, got {text}") from error
    return first, second
