"""Features on disk, shared by the combinations of one detector and descriptor."""

from __future__ import annotations

import io
import shutil
import zipfile
import zlib
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np

from aerocues.evaluation.whole_files import write_whole
from aerocues.methods.arrays import Features, Keypoints
from aerocues.methods.combination import Combination
from aerocues.reconstruction.scene import FEATURES, Scene

KEYPOINTS = tuple(field.name for field in fields(Keypoints))
BROKEN = (ValueError, KeyError, EOFError, zipfile.BadZipFile, zlib.error)


@dataclass(frozen=True, eq=False)
class TimedFeatures:
    """Features of an image and the CPU seconds that they took."""

    features: Features
    seconds: float


class FeatureFiles:
    """One file an image, under the hash of all that decides its content."""

    def __init__(self, scene: Scene, combination: Combination) -> None:
        self._scene = scene
        self._combination = combination
        self.folder = features_folder(scene.folder, combination)
        self.folder.mkdir(parents=True, exist_ok=True)

    def read(self, image: str) -> TimedFeatures | None:
        """What is there for an image; None where there is nothing, or it is damaged."""
        file = self._file(image)
        if not file.is_file():
            return None
        try:
            with np.load(file, allow_pickle=False) as arrays:
                keypoints = Keypoints(**{name: arrays[name] for name in KEYPOINTS})
                features = Features(keypoints, arrays["descriptors"])
                return TimedFeatures(features, float(arrays["seconds"]))
        except BROKEN:
            return None

    def write(self, image: str, found: TimedFeatures) -> None:
        """Keep features; OSError where there is no room."""
        content = io.BytesIO()
        keypoints = {name: getattr(found.features.keypoints, name) for name in KEYPOINTS}
        np.savez(
            content,
            **keypoints,
            descriptors=found.features.descriptors,
            seconds=np.float64(found.seconds),
        )
        write_whole({self._file(image): content.getbuffer()})

    def _file(self, image: str) -> Path:
        return self.folder / f"{self._scene.features_key(image, self._combination)}.npz"


def features_folder(folder: Path, combination: Combination) -> Path:
    """Where the features of a detector and descriptor lie."""
    return folder / FEATURES / f"{combination.detector}-{combination.descriptor}"


def remove_features(folder: Path, combination: Combination | None = None) -> None:
    """Make room: descriptors are many times larger than what is made of them."""
    place = folder / FEATURES if combination is None else features_folder(folder, combination)
    shutil.rmtree(place, ignore_errors=True)
