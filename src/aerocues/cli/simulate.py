"""`aerocues simulate`: flies a survey over a scene that never was, with exact ground truth."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from aerocues.cli.console import count

if TYPE_CHECKING:
    from aerocues.simulation.flight import Settings


def simulate(
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="DIR", help="Folder of the flight.")
    ],
    survey: Annotated[
        str,
        typer.Option(
            metavar="NAME", help="airsimnh, airsimnh-natural, mini, or a JSON file with a mission."
        ),
    ] = "mini",
    subset: Annotated[
        str | None,
        typer.Option(metavar="GLOBS", help="These images or folders only: 'Layer3/pitch-90_yaw0'."),
    ] = None,
    scene: Annotated[
        str,
        typer.Option(metavar="NAME", help="What is flown over: suburb, fields or industrial."),
    ] = "suburb",
    seed: Annotated[int, typer.Option(min=0, metavar="N", help="Of the scene and the noise.")] = 0,
    size: Annotated[str, typer.Option(metavar="WxH", help="Pixels.")] = "1000x665",
    fov: Annotated[float, typer.Option(metavar="DEGREES", help="Horizontal field of view.")] = 90.0,
    sun: Annotated[
        str, typer.Option(metavar="AZ,EL", help="Azimuth from north, elevation; degrees.")
    ] = "140,48",
    haze: Annotated[float, typer.Option(min=0.0, metavar="AMOUNT", help="0 for clear air.")] = 0.2,
    glints: Annotated[
        float,
        typer.Option(
            min=0.0, metavar="AMOUNT", help="Leaves and roofs look different from each side."
        ),
    ] = 1.0,
    noise: Annotated[
        float, typer.Option(min=0.0, metavar="AMOUNT", help="Of the sensor; 0 for none.")
    ] = 1.0,
    blur: Annotated[
        float, typer.Option(min=0.0, metavar="PIXELS", help="Of the lens, pixels.")
    ] = 0.55,
    motion: Annotated[
        float, typer.Option(min=0.0, metavar="PIXELS", help="Motion blur, pixels.")
    ] = 0.0,
    exposure_jitter: Annotated[
        float, typer.Option(min=0.0, metavar="STOPS", help="From image to image, stops.")
    ] = 0.0,
    interval: Annotated[
        float,
        typer.Option(min=0.0, metavar="SECONDS", help="Seconds between images: cars drive on."),
    ] = 0.0,
    wind: Annotated[
        float,
        typer.Option(
            "--wind",
            "--wind-trees",
            min=0.0,
            metavar="METRES",
            help="Moves crowns by so many metres (--interval).",
        ),
    ] = 0.0,
    form: Annotated[str, typer.Option("--format", metavar="NAME", help="png or jpeg.")] = "png",
) -> None:
    """Simulate a survey flight: images, poses, depth. Goes on where an earlier run broke off."""
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
    """Two numbers with a mark between them, as an option has them."""
    try:
        first, second = (float(part) for part in text.lower().split(mark))
    except ValueError as error:
        raise typer.BadParameter(f"{option} {text}: write it like {example}") from error
    return first, second
