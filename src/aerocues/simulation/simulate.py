"""Simulated flights, as users of the library ask for them."""

from __future__ import annotations

from collections.abc import Mapping
from numbers import Real
from pathlib import Path
from typing import Any

from aerocues.datasets.catalog import open_dataset
from aerocues.datasets.dataset import Dataset
from aerocues.defaults import SIZE, SUN
from aerocues.errors import ArgumentError
from aerocues.progress import Progress
from aerocues.simulation.flight import Flown, Settings, fly
from aerocues.simulation.lighting import Weather
from aerocues.simulation.planner import Mission, open_survey
from aerocues.simulation.sensor import Sensor


def simulate(
    survey: str | Path | Mapping[str, object] | Mission = "mini",
    output: str | Path = "flight",
    *,
    scene: str = "suburb",
    subset: str | None = None,
    seed: int = 0,
    size: str | tuple[int, int] = SIZE,
    fov: float = 90.0,
    sun: str | tuple[float, float] = SUN,
    haze: float = 0.2,
    glints: float = 1.0,
    noise: float = 1.0,
    blur: float = 0.55,
    motion: float = 0.0,
    exposure_jitter: float = 0.0,
    interval: float = 0.0,
    wind: float = 0.0,
    image_format: str = "png",
    progress: Progress | None = None,
) -> Dataset:
    """Simulate a survey flight: images with exact poses and depth.

    Images that are there, made with the same settings, are kept; what was interrupted goes on.

    Parameters
    ----------
    survey : str, path, mapping or Mission
        ``airsimnh``, ``airsimnh-natural`` or ``mini``, the JSON file of a mission, or its terms:
        ``{"pattern": "nadir", "north": 60, "east": 60, "altitude": 40}``; see
        `aerocues.simulation.planner.Mission`.
    output : path
        Folder of the flight, made where it is missing.
    scene : {"suburb", "fields", "industrial"}
        What is flown over.
    subset : str, optional
        Render only the images whose name or folder matches one of these globs, separated by commas.
    seed : int
        Of the scene and the noise.
    size : str or tuple of int
        Width and height in pixels, ``"1000x665"`` or ``(1000, 665)``.
    fov : float
        Horizontal field of view in degrees.
    sun : str or tuple of float
        Azimuth from north and elevation in degrees, ``"140,48"`` or ``(140, 48)``.
    haze, glints : float
        0 for clear air; how much leaves and roofs change with the viewing direction.
    noise, blur, motion : float
        Sensor noise, 0 for none; blur of the lens and of motion in pixels.
    exposure_jitter : float
        Exposure changes between images, in stops.
    interval, wind : float
        Seconds between images, in which cars move; metres by which the wind then moves crowns.
    image_format : {"png", "jpeg"}
    progress : callable, optional
        Called with each `aerocues.Event`.

    Returns
    -------
    Dataset
        The flight, as ``open_dataset("simulated:FOLDER")`` gives it.

    Raises
    ------
    AerocuesError
        If an argument makes no sense, the folder holds something else, or the flight has fewer
        than two images.
    """
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
        progress=progress,
    )
    return open_dataset(f"simulated:{output}")


def fly_survey(
    survey: str | Path | Mapping[str, object] | Mission,
    output: str | Path,
    *,
    progress: Progress | None = None,
    subset: str | None,
    size: str | tuple[float, float],
    sun: str | tuple[float, float],
    haze: float,
    glints: float,
    noise: float,
    blur: float,
    motion: float,
    exposure_jitter: float,
    image_format: str,
    **settings: Any,
) -> Flown:
    """The same, without opening the flight, which may have one image only."""
    width, height = two_numbers("size", size, "x", SIZE)
    azimuth, elevation = two_numbers("sun", sun, ",", SUN)
    asked = Settings(
        width=int(width),
        height=int(height),
        weather=Weather(azimuth, elevation, haze, glints),
        sensor=Sensor(noise, blur, motion, exposure_jitter=exposure_jitter),
        form=image_format,
        **settings,
    )
    return fly(Path(output), open_survey(survey, asked.camera), asked, progress, subset)


def two_numbers(
    parameter: str, value: str | tuple[float, float], mark: str, example: str
) -> tuple[float, float]:
    """Two numbers, as a pair or as a text with a mark between them.

    Raises
    ------
    ArgumentError
        If it is neither.
    """
    parts = value.lower().split(mark) if isinstance(value, str) else value
    try:
        first, second = (float(part) for part in parts if isinstance(part, str | Real))
    except (TypeError, ValueError) as error:
        raise ArgumentError(f"`{parameter}` must be like {example}, got {value!r}") from error
    return first, second
