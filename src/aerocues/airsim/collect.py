"""A survey flown in AirSim, with the same files as a simulated flight."""

from __future__ import annotations

import contextlib
import hashlib
import json
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

from aerocues.airsim.camera import Photograph, SimulatorCamera
from aerocues.airsim.connection import Connection
from aerocues.datasets.dataset import PinholeCamera
from aerocues.errors import SimulationError
from aerocues.progress import Progress, StageProgress
from aerocues.simulation.camera import Pose, pinhole
from aerocues.simulation.exports import write_poses
from aerocues.simulation.flight import SUFFIXES, Flown, shots_in
from aerocues.simulation.flight_folder import FlightFolder, write_depth, write_json
from aerocues.simulation.georeference import geodetic
from aerocues.simulation.metadata import write_image
from aerocues.simulation.surveys import Survey

COLLECTOR_VERSION = "1"
PORT = 41451
WAITS = (0.5, 1.0, 2.0, 4.0, 8.0)
"""Seconds before each attempt to connect again."""


@dataclass(frozen=True)
class Collection:
    """What is asked of the simulator.

    Parameters
    ----------
    host : str
    port : int
    flavour : {"airsim", "cosys"} or None
        None: find out.
    width, height : int
        Pixels, as the simulator's settings.json must have them.
    fov : float
        Horizontal field of view in degrees.
    form : str
        ``png`` or ``jpeg``.
    timeout : float
        Seconds that an answer may take.
    """

    host: str = "127.0.0.1"
    port: int = PORT
    flavour: str | None = None
    width: int = 1000
    height: int = 665
    fov: float = 90.0
    form: str = "png"
    timeout: float = 60.0

    def __post_init__(self) -> None:
        if self.form not in SUFFIXES:
            raise SimulationError(f"format '{self.form}' is unknown; use {', '.join(SUFFIXES)}")

    @property
    def camera(self) -> PinholeCamera:
        """The camera of all images."""
        return pinhole(self.width, self.height, self.fov)

    @property
    def address(self) -> str:
        """Host and port."""
        return f"{self.host}:{self.port}"


def collect(
    folder: Path,
    survey: Survey,
    asked: Collection,
    progress: Progress | None = None,
    subset: str | None = None,
    sleep: Callable[[float], None] = time.sleep,
) -> Flown:
    """Fly a survey in a running simulator; images that are there are kept.

    A lost connection is made anew a few times; after that the same call goes on where it ended.

    Parameters
    ----------
    folder : Path
        Is made where it is missing.
    survey : Survey
    asked : Collection
    progress : callable, optional
        Called with each `aerocues.Event`, first with the number of images that are kept.
    subset : str, optional
        As `simulation.flight.fly` takes it.
    sleep : callable
        Waits for so many seconds.

    Raises
    ------
    SimulationError
        If there is no simulator, it does not do as it is told, or the folder holds something else.
    """
    chosen = shots_in(survey, subset, asked.form)
    place = FlightFolder(folder)
    names = [f"{shot.name}{SUFFIXES[asked.form]}" for shot in survey.shots]
    keys = {n: _key(asked, shot.pose) for n, shot in zip(names, survey.shots, strict=True)}
    with _Session(asked, sleep) as session:  # before anything is taken away or written
        place.keep(keys)
        poses = [shot.pose for shot in survey.shots]
        write_poses(place.truth, names, poses, [0.0] * len(names), asked.camera)
        facts = {"flavour": session.flavour, "server_version": session.server_version}
        write_json(
            place.truth / "camera.json",
            {"camera": asdict(asked.camera), "collector": "airsim", **facts, **_settings(asked)},
        )
        left = [number for number in chosen if not place.has(names[number])]
        kept = len(chosen) - len(left)
        stage = StageProgress(progress, "collecting", "images", kept, len(chosen))
        stage.tell()
        for done, number in enumerate(left, start=1):
            name = names[number]
            _write(place, name, poses[number], session.take(poses[number]), asked)
            place.add(name, keys[name])
            stage.tell(done=kept + done, share=done / len(left))
    return Flown(len(left), kept)


def _write(
    place: FlightFolder, name: str, pose: Pose, photograph: Photograph, asked: Collection
) -> None:
    for got in (photograph.rgb.shape[:2], photograph.depth.shape):
        if got != (asked.height, asked.width):
            raise SimulationError(
                f"the simulator's images have {got[1]} x {got[0]} pixels; set "
                f'"Width": {asked.width}, "Height": {asked.height} for ImageType 0 and 1 in the '
                f"CaptureSettings of its settings.json, or ask for {got[1]} x {got[0]}"
            )
    for path in (place.image(name), place.depth(name)):
        path.parent.mkdir(parents=True, exist_ok=True)
    write_depth(place.depth(name), photograph.depth)
    gps = geodetic(pose.north, pose.east, pose.down)
    write_image(place.image(name), photograph.rgb, asked.camera, pose, gps)


def _settings(asked: Collection) -> dict[str, object]:
    return {"width": asked.width, "height": asked.height, "fov": asked.fov, "form": asked.form}


def _key(asked: Collection, pose: Pose) -> str:
    facts = [COLLECTOR_VERSION, _settings(asked), asdict(pose)]
    return hashlib.sha256(json.dumps(facts, sort_keys=True).encode()).hexdigest()[:16]


class _Session:
    """A camera that is connected again when the connection is lost."""

    def __init__(self, asked: Collection, sleep: Callable[[float], None]) -> None:
        self._asked, self._sleep = asked, sleep
        self._connection: Connection | None = None
        try:
            self._camera = self._connect()
        except OSError as error:
            raise SimulationError(
                f"no simulator answers at {asked.address} ({error}); start AirSim or "
                "Cosys-AirSim in ComputerVision mode, or give its `host` and `port`"
            ) from error
        self.flavour, self.server_version = self._camera.flavour, self._camera.server_version

    def __enter__(self) -> _Session:
        return self

    def __exit__(self, *_: object) -> None:
        if self._connection is not None:
            # Where it is gone already, or will not listen, nothing is left to release.
            with contextlib.suppress(OSError, SimulationError):
                self._camera.release()
            self._connection.close()

    def _connect(self) -> SimulatorCamera:
        asked = self._asked
        self._connection = Connection(asked.host, asked.port, asked.timeout)
        try:
            return SimulatorCamera(self._connection, asked.flavour, asked.fov)
        except (OSError, SimulationError):
            self._connection.close()
            raise

    def take(self, pose: Pose) -> Photograph:
        """A photograph from a pose; SimulationError if the connection stays lost."""
        try:
            return self._camera.take(pose)
        except OSError as error:
            lost = error
        for wait in WAITS:
            self._sleep(wait)
            try:
                self._camera = self._connect()
                return self._camera.take(pose)
            except OSError as error:
                lost = error
        raise SimulationError(
            f"lost the connection to {self._asked.address} ({lost}); start the simulator again "
            "and run the same command: what is finished is kept"
        )
