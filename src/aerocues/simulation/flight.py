"""Simulated flights: images with ground truth beside them, in one folder that can be gone on with.

::

    DIR/Layer1/pitch-90_yaw0/000_z-60_y-160_x-160.png    images
    DIR/truth/poses.csv, trajectory.tum, sparse/         poses
    DIR/truth/camera.json                                intrinsics and settings
    DIR/truth/depth/Layer1/.../000_z-60_y-160_x-160.npy  depth, float32 metres
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, dataclass, field
from pathlib import Path

import numpy as np

from aerocues.arguments import check_whole
from aerocues.datasets.dataset import PinholeCamera
from aerocues.datasets.options import Options
from aerocues.errors import SimulationError
from aerocues.progress import Progress, StageProgress
from aerocues.simulation.camera import Pose, pinhole
from aerocues.simulation.exports import write_poses
from aerocues.simulation.flight_folder import FlightFolder, write_depth, write_json
from aerocues.simulation.georeference import geodetic
from aerocues.simulation.lighting import Weather
from aerocues.simulation.metadata import write_image
from aerocues.simulation.rendering import Stage, render
from aerocues.simulation.scenes import HALF, build_scene, require_scene, stage
from aerocues.simulation.sensor import Sensor, develop
from aerocues.simulation.surveys import Shot, Survey

RENDERER_VERSION = "2"
"""Part of the keys of frames; raised when pictures come to differ for the same settings."""

SUFFIXES = {"png": ".png", "jpeg": ".jpg"}


@dataclass(frozen=True)
class Settings:
    """What is flown over, and with what.

    Parameters
    ----------
    scene : str
        Name of a row of `scenes.SCENES`.
    seed : int
        Of the scene and of the sensor's noise.
    width, height : int
        Pixels.
    fov : float
        Horizontal field of view in degrees.
    weather : Weather
    sensor : Sensor
    interval : float
        Seconds from image to image: cars drive on. 0: all are of one moment.
    wind : float
        Metres by which the wind moves crowns.
    form : str
        ``png`` or ``jpeg``.
    """

    scene: str = "suburb"
    seed: int = 0
    width: int = 1000
    height: int = 665
    fov: float = 90.0
    weather: Weather = field(default_factory=Weather)
    sensor: Sensor = field(default_factory=Sensor)
    interval: float = 0.0
    wind: float = 0.0
    form: str = "png"

    def __post_init__(self) -> None:
        if self.form not in SUFFIXES:
            raise SimulationError(f"format '{self.form}' is unknown; use {', '.join(SUFFIXES)}")
        check_whole("seed", self.seed, 0)
        if min(self.width, self.height) < 16 or not 1.0 <= self.fov <= 150.0:
            raise SimulationError("images need 16 pixels a side and a field of view of 1 to 150")

    @property
    def camera(self) -> PinholeCamera:
        """The camera of all images."""
        return pinhole(self.width, self.height, self.fov)


@dataclass(frozen=True)
class Flown:
    """How many images were rendered, and how many were there already."""

    rendered: int
    kept: int


def fly(
    folder: Path,
    survey: Survey,
    settings: Settings,
    progress: Progress | None = None,
    subset: str | None = None,
) -> Flown:
    """Fly a survey; images that are there, made with the same settings, are kept.

    Those that were made with other settings, or belong to another survey, are taken away first.

    Parameters
    ----------
    folder : Path
        Is made where it is missing.
    survey : Survey
    settings : Settings
    progress : callable, optional
        Called with each `aerocues.Event`, first with the number of images that are kept.
    subset : str, optional
        Render only the images whose name or folder matches one of these globs, separated by commas;
        the poses are those of the whole survey.

    Raises
    ------
    SimulationError
        If there is no such scene, the subset is empty, or the folder holds something else.
    """
    require_scene(settings.scene)
    chosen = shots_in(survey, subset, settings.form)
    place = FlightFolder(folder)
    times = [index * settings.interval for index in range(len(survey.shots))]
    names = [f"{shot.name}{SUFFIXES[settings.form]}" for shot in survey.shots]
    half = _half(survey, settings.camera)
    keys = {
        name: _key(settings, shot, time, half)
        for name, shot, time in zip(names, survey.shots, times, strict=True)
    }
    place.keep(keys)
    write_poses(place.truth, names, [shot.pose for shot in survey.shots], times, settings.camera)
    write_json(place.truth / "camera.json", {"camera": asdict(settings.camera), **asdict(settings)})
    left = [number for number in chosen if not place.has(names[number])]
    kept, studio = len(chosen) - len(left), _Studio(settings, half)
    stage = StageProgress(progress, "rendering", "images", kept, len(chosen))
    stage.tell()
    for done, number in enumerate(left, start=1):
        name, pose = names[number], survey.shots[number].pose
        studio.take(pose, times[number], number, place.image(name), place.depth(name))
        place.add(name, keys[name])
        stage.tell(done=kept + done, share=done / len(left))
    return Flown(len(left), kept)


def shots_in(survey: Survey, subset: str | None, form: str) -> list[int]:
    """Numbers of the shots of a survey whose name or folder is in a subset; None: of all.

    Raises
    ------
    SimulationError
        If there is none.
    """
    options = Options(subset=subset)
    chosen = [
        i for i, shot in enumerate(survey.shots) if options.takes(f"{shot.name}{SUFFIXES[form]}")
    ]
    if not chosen:
        folders = list(dict.fromkeys(shot.name.rpartition("/")[0] for shot in survey.shots))
        shown = ", ".join(folders[:4]) + (", ..." if len(folders) > 4 else "")
        raise SimulationError(
            f'no image of {survey.name} is in `subset="{subset}"`; there are: {shown}'
        )
    return chosen


class _Studio:
    """The scene, built when the first image is taken, and its light at the moment of the last."""

    def __init__(self, settings: Settings, half: float) -> None:
        self._settings, self._half = settings, half
        self._stage: Stage | None = None
        self._time = 0.0

    def take(self, pose: Pose, time: float, number: int, image: Path, depth: Path) -> None:
        settings, camera = self._settings, self._settings.camera
        rendering = render(self._at(time), camera, pose)
        rng = np.random.default_rng([settings.seed, number])
        pixels = develop(rendering.radiance, settings.sensor, rng)
        image.parent.mkdir(parents=True, exist_ok=True)
        depth.parent.mkdir(parents=True, exist_ok=True)
        write_depth(depth, rendering.depth)
        write_image(image, pixels, camera, pose, geodetic(pose.north, pose.east, pose.down))

    def _at(self, time: float) -> Stage:
        if self._stage is None or time != self._time:
            settings = self._settings
            if self._stage is None:
                self._scene = build_scene(settings.scene, settings.seed, self._half)
            self._stage = stage(self._scene, settings.weather, time, settings.wind)
            self._time = time
        return self._stage


def _half(survey: Survey, camera: PinholeCamera) -> float:
    """How far from the origin the survey sees details, but not farther than `scenes.HALF`."""
    diagonal = float(np.hypot(camera.width / camera.focal_x, camera.height / camera.focal_y)) / 2
    reach = 0.0
    for shot in survey.shots:
        pose = shot.pose
        tilt = min(abs(pose.pitch + 90.0) + np.degrees(np.arctan(diagonal)), 72.0)
        seen = -pose.down * float(np.tan(np.radians(tilt)))
        reach = max(reach, max(abs(pose.north), abs(pose.east)) + seen)
    return float(min(np.ceil((reach + 10.0) / 10.0) * 10.0, HALF))


def _key(settings: Settings, shot: Shot, time: float, half: float) -> str:
    facts = {"settings": asdict(settings), "shot": asdict(shot), "time": time, "half": half}
    text = json.dumps([RENDERER_VERSION, facts], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]
