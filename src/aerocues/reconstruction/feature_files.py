"""Features on disk, shared by the combinations of one detector and descriptor."""

from __future__ import annotations

import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from aerocues.methods.arrays import Features
from aerocues.methods.combination import Combination
from aerocues.pipeline.feature_arrays import (
    KEYPOINTS,
    keypoint_arrays,
    keypoints_of,
    read_arrays,
    write_arrays,
)
from aerocues.reconstruction.scene import FEATURES, Scene


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
        arrays = read_arrays(self._file(image), (*KEYPOINTS, "descriptors", "seconds"))
        if arrays is None:
            return None
        descriptors: Any = arrays["descriptors"]
        features = Features(keypoints_of(arrays), descriptors)
        return TimedFeatures(features, float(arrays["seconds"]))

    def write(self, image: str, found: TimedFeatures) -> None:
        """Keep features; OSError where there is no room."""
        arrays = keypoint_arrays(found.features.keypoints)
        arrays |= {"descriptors": found.features.descriptors, "seconds": np.array(found.seconds)}
        write_arrays(self._file(image), arrays)

    def _file(self, image: str) -> Path:
        return self.folder / f"{self._scene.features_key(image, self._combination)}.npz"


def features_folder(folder: Path, combination: Combination) -> Path:
    """Where the features of a detector and descriptor lie."""
    return folder / FEATURES / f"{combination.detector}-{combination.descriptor}"


def remove_features(folder: Path, combination: Combination | None = None) -> None:
    """Make room: descriptors are many times larger than what is made of them."""
    place = folder / FEATURES if combination is None else features_folder(folder, combination)
    shutil.rmtree(place, ignore_errors=True)
