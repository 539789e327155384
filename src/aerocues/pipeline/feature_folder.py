"""Features on disk, for runs that come later: other matchers, more pairs, another protocol."""

from __future__ import annotations

from dataclasses import astuple
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.dataset import Image
from aerocues.errors import StoreError
from aerocues.methods.arrays import Features, Keypoints
from aerocues.methods.parameters import AEROCUES, OPENCV
from aerocues.methods.registry import Methods
from aerocues.pipeline.clock import StageTime
from aerocues.pipeline.feature_arrays import (
    KEYPOINTS,
    Arrays,
    keypoint_arrays,
    keypoints_of,
    read_arrays,
    write_arrays,
)
from aerocues.pipeline.features import Described
from aerocues.pipeline.protocol import MEASUREMENT_VERSION, MeasurementProtocol
from aerocues.results.hashing import content_hash

TIME = "time"
IMAGE_SIZE = "image_size"


def checked_folder(folder: Path) -> Path:
    """The folder, made where it is missing.

    Raises
    ------
    StoreError
        If it cannot be made or is something else.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except FileExistsError as error:
        raise StoreError(
            f"cannot keep features in {folder}: it is a file; give a folder as `features`"
        ) from error
    except OSError as error:
        raise StoreError(
            f"cannot keep features in {folder}: {error.strerror}; choose another folder as "
            "`features`"
        ) from error
    return folder


class FeatureFolder:
    """Keypoints and descriptors with the times that they took, one file each.

    A file's name is the hash of all that decides its content: pixels, methods, limit, seed and
    versions; and, for the times, of the machine and of how they were taken. ``problem`` says why
    nothing is kept any more.

    Parameters
    ----------
    folder : path
    methods : Methods
    protocol : MeasurementProtocol
    machine : str
    """

    def __init__(
        self, folder: Path, methods: Methods, protocol: MeasurementProtocol, machine: str
    ) -> None:
        self._methods = methods
        self._folder = folder
        self.problem: str | None = None
        alone = protocol.timing == "exclusive"
        self._common = [MEASUREMENT_VERSION, cv2.__version__, machine, alone]
        self._common += [protocol.seed, protocol.limit.count, protocol.limit.spread]

    def keypoints(self, image: Image, detector: str) -> tuple[Keypoints, StageTime] | None:
        """What a detector found in an image; None where that is not here.

        An extractor finds keypoints and descriptors at once: the ones are of no use without the
        others, which an interruption may have prevented.
        """
        if self._extracts(detector) and self.described(image, detector, detector) is None:
            return None
        found = read_arrays(self._file(image, detector), (*KEYPOINTS, TIME))
        return None if found is None else (keypoints_of(found), _read_time(found[TIME]))

    def keep_keypoints(
        self, image: Image, detector: str, keypoints: Keypoints, time: StageTime
    ) -> None:
        """Keep what a detector found."""
        arrays = {**keypoint_arrays(keypoints), TIME: _written(time)}
        self._write(self._file(image, detector), arrays)

    def described(self, image: Image, detector: str, descriptor: str) -> Described | None:
        """What a descriptor made of an image's keypoints; None where that is not here."""
        file = self._file(image, detector, descriptor)
        found = read_arrays(file, (*KEYPOINTS, "descriptors", IMAGE_SIZE, TIME))
        if found is None:
            return None
        descriptors: Any = found["descriptors"]
        width, height = found[IMAGE_SIZE].tolist()
        features = Features(keypoints_of(found), descriptors, (width, height), image.turn or 0)
        return Described(features, _read_time(found[TIME]))

    def keep_described(
        self, image: Image, detector: str, descriptor: str, described: Described
    ) -> None:
        """Keep what a descriptor made of an image's keypoints."""
        features = described.features
        arrays = keypoint_arrays(features.keypoints)
        arrays |= {"descriptors": features.descriptors, TIME: _written(described.time)}
        arrays[IMAGE_SIZE] = np.array(features.image_size)
        self._write(self._file(image, detector, descriptor), arrays)

    def _extracts(self, detector: str) -> bool:
        """Whether a detector is an extractor of a plug-in."""
        described = self._methods.descriptors.get(detector)
        return (
            described is not None
            and described.origin not in (OPENCV, AEROCUES)
            and described.factory == self._methods.detectors[detector].factory
        )

    def _file(self, image: Image, detector: str, descriptor: str = "") -> Path:
        methods = [dict(self._methods.detectors[detector].parameters)]
        if descriptor:
            methods.append(dict(self._methods.descriptor_on(descriptor, detector).parameters))
        key = content_hash([self._common, image.features_key(), methods])
        return self._folder / "-".join(filter(None, (detector, descriptor))) / f"{key}.npz"

    def _write(self, file: Path, arrays: Arrays) -> None:
        """Write; where there is no room, note it and measure on without."""
        if self.problem is not None:
            return
        try:
            file.parent.mkdir(parents=True, exist_ok=True)
            write_arrays(file, arrays)
        except OSError as error:
            self.problem = f"features are kept no longer in {self._folder}: {error.strerror}"


def _written(time: StageTime) -> NDArray[np.float64]:
    """A time as numbers; what is unknown is not a number."""
    return np.array([np.nan if value is None else value for value in astuple(time)])


def _read_time(numbers: NDArray[Any]) -> StageTime:
    wall, cpu, memory, repeats, spread = (
        None if np.isnan(number) else float(number) for number in numbers
    )
    times = None if repeats is None else int(repeats)
    return StageTime(wall or 0.0, cpu or 0.0, memory, times, spread)
