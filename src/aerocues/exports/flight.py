"""Features, matches and verified links of a flight, ready to be written for another tool."""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.dataset import Dataset
from aerocues.datasets.decoding import FileSource
from aerocues.datasets.header import read_header
from aerocues.errors import ReconstructionError
from aerocues.methods.arrays import DescriptorArray
from aerocues.methods.combination import Combination
from aerocues.methods.descriptors import DescriptorRow
from aerocues.pipeline.feature_folder import FeatureFolder
from aerocues.progress import Progress, StageProgress
from aerocues.reconstruction.engine import link_images
from aerocues.reconstruction.feature_size import smaller
from aerocues.reconstruction.linked_scene import LINKED, VERIFIED
from aerocues.reconstruction.matched_scene import MatchedScene, Names, read_matched_scene
from aerocues.reconstruction.one_model import DATABASE
from aerocues.reconstruction.options import ReconstructionOptions
from aerocues.reconstruction.prepared import Prepared, read_prepared
from aerocues.reconstruction.reconstruction_progress import ReconstructionProgress
from aerocues.reconstruction.scene import IMAGES, CameraGroup, Scene
from aerocues.reconstruction.scene_making import (
    check_scene,
    chosen_combinations,
    scene_of,
    with_cameras,
)

Indices = NDArray[np.int32]
FOCAL_GUESS = 1.2
"""Focal length of an unknown camera, by its longer side, as COLMAP guesses it."""


@dataclass(frozen=True, eq=False)
class Flight:
    """A scene with its features, matches and links.

    Parameters
    ----------
    scene : Scene
    combination : Combination
    sizes : mapping of str to Prepared
        Width and height of the measured images by name.
    linked : MatchedScene
        Keypoints of all images, and of the pairs that beat chance the matches that agree with their
        geometry.
    verified : mapping of pairs to (K, 2) int32
        Indices of the keypoints of the matches that COLMAP verified.
    """

    scene: Scene
    combination: Combination
    sizes: Mapping[str, Prepared]
    linked: MatchedScene
    verified: Mapping[Names, Indices]

    @property
    def images(self) -> list[str]:
        """Names of the images, in their order."""
        return [image.name for image in self.scene.dataset.images]

    @property
    def descriptor(self) -> DescriptorRow:
        """The row of the descriptor."""
        methods, one = self.scene.methods, self.combination
        return methods.descriptor_on(one.descriptor, one.detector)

    @property
    def database(self) -> Path:
        """COLMAP's database of all this."""
        return self.scene.place(self.combination) / DATABASE

    def descriptors(self, name: str) -> DescriptorArray:
        """The descriptors of an image, a row for each keypoint: empty ones of a pair matcher."""
        scene, one = self.scene, self.combination
        if one.of_pairs:
            return np.empty((len(self.linked.keypoints[name]), 0), np.float32)
        folder = FeatureFolder(scene.features, scene.methods, scene.measurement(), scene.machine)
        image = smaller(scene.dataset.image(name), scene.protocol.features_width)
        found = folder.described(image, one.detector, one.descriptor)
        if found is None:  # there were no keypoints to describe
            row = self.descriptor
            return np.empty((0, max(row.columns, 1)), row.dtype)
        return found.features.descriptors

    def camera(self, name: str) -> CameraGroup:
        """The camera of an image."""
        return next(group for group in self.scene.cameras if name in group.names)

    def focal_length(self, name: str) -> float | None:
        """The focal length of an image in pixels; None where it is not known."""
        parameters = self.camera(name).parameters
        return parameters[0] if parameters else None

    def move_images(self, folder: Path) -> None:
        """Put the measured images where the tool expects them."""
        target = folder / IMAGES
        if target.exists():
            shutil.rmtree(target)
        shutil.move(self.scene.images, target)

    def copy_originals(self, folder: Path) -> None:
        """Put the original files where the tool expects them, with their EXIF data.

        Measured ones take the place of those that the tool would turn.
        """
        target = folder / IMAGES
        target.mkdir(exist_ok=True)
        for name in self.images:
            shutil.copyfile(self.original(name) or self.scene.images / name, target / flat(name))

    def original(self, name: str) -> Path | None:
        """The file of an image that shows the same as the measured one, at any size."""
        source = self.scene.dataset.image(name).source
        if not isinstance(source, FileSource):
            return None
        header = read_header(source.path, str(source.path))
        return source.path if header.orientation == 1 else None


def flat(name: str) -> str:
    """The name of an image for tools that know no folders of images."""
    return name.replace("/", "_")


def linked_flight(
    dataset: Dataset,
    combination: str | Combination,
    place: Path,
    options: ReconstructionOptions,
    progress: Progress | None = None,
) -> Flight:
    """Detect, describe, match and verify a whole flight, as a reconstruction does.

    Parameters
    ----------
    dataset : Dataset
    combination : str or Combination
    place : path
        Folder of the images and files, some of which tools get.
    options : ReconstructionOptions
    progress : callable, optional

    Raises
    ------
    ReconstructionError
        If the flight cannot be linked.
    """
    check_scene(dataset)
    scene, limits = scene_of(dataset, place, options), options.limits()
    [one] = chosen_combinations(scene, [str(combination)], ReconstructionProgress(progress))
    scene.images.mkdir(parents=True, exist_ok=True)
    scene = with_cameras(scene, limits, ReconstructionProgress(progress))
    row = link_images(scene, one, limits, StageProgress(progress, "matching").watch)
    if row["status"] != "ok":
        raise ReconstructionError(
            f"{one} does not link the images of {dataset.name}: {row['message']}; use another "
            "combination, such as the best of `aerocues.recommend`"
        )
    key = scene.matching_key(one)
    linked, verified = (
        read_matched_scene(scene.place(one) / file, key) for file in (LINKED, VERIFIED)
    )
    assert linked is not None
    assert verified is not None
    sizes = read_prepared(scene.folder, scene.image_keys)
    pairs = {names: matches.indices for names, matches in verified.pairs.items()}
    return Flight(scene, one, sizes, linked, pairs)
