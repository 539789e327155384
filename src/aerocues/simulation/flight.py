"""Simulated flights: images and their ground truth in one folder, which can be continued.

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
"""Part of the keys of frames; increased when the same settings give other images."""

SUFFIXES = {"png": ".png", "jpeg": ".jpg"}


@dataclass(frozen=True)
class Settings:
    """Scene, camera and conditions of a flight.

    Parameters
    ----------
    scene : str
        Name of a row of `scenes.SCENES`.
    seed : int
        Seed of the scene and of the sensor noise.
    width, height : int
        Pixels.
    fov : float
        Horizontal field of view in degrees.
    weather : Weather
    sensor : Sensor
    interval : float
        Seconds between images, in which cars move. 0: all images show the same moment.
    wind : float
        How far the wind moves tree crowns, in metres.
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
            raise SimulationError(
                "width and height must be at least 16 pixels, the field of view 1 to 150 degrees"
            )

    @property
    def camera(self) -> PinholeCamera:
        """The camera of all images."""
        return pinhole(self.width, self.height, self.fov)


@dataclass(frozen=True)
class Flown:
    """Numbers of rendered images and of kept ones."""

    rendered: int
    kept: int


def fly(
    folder: Path,
    survey: Survey,
    settings: Settings,
    progress: Progress | None = None,
    subset: str | None = None,
) -> Flown:
    """Fly a survey; existing images with the same settings are kept.

    Images with other settings, or of another survey, are removed first.

    Parameters
    ----------
    folder : Path
        Created if missing.
    survey : Survey
    settings : Settings
    progress : callable, optional
        Called with each `aerocues.Event`, first with the number of images that are kept.
    subset : str, optional
        Render only the images whose name or folder matches one of these globs, separated by commas.
        The poses of the whole survey are written.

    Raises
    ------
    SimulationError
        If there is no such scene, the subset is empty, or the folder has other files.
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
    """Indices of the shots of a survey in a subset; None: all shots.

    Raises
    ------
    SimulationError
        If the subset is empty.
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
    """The scene, built for the first image, and its light at the time of the latest image."""

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
    """Distance from the origin that the survey can see, at most `scenes.HALF`."""
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
