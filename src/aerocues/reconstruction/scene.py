"""A scene to be reconstructed, its work, and the keys of both."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

from aerocues.datasets.dataset import Dataset
from aerocues.methods.combination import Combination
from aerocues.methods.registry import Methods
from aerocues.reconstruction.protocol import ReconstructionProtocol
from aerocues.results.hashing import content_hash

IMAGES = "images"
FEATURES = "features"


@dataclass(frozen=True)
class CameraGroup:
    """Images taken with one camera.

    Parameters
    ----------
    model : str
        COLMAP's name of the camera model.
    parameters : tuple of float
        In COLMAP's order and convention (the centre of the top-left pixel is (0.5, 0.5)); empty
        where nothing is known, which COLMAP then guesses.
    source : str
        Where the focal length is from.
    names : tuple of str
    """

    model: str
    parameters: tuple[float, ...]
    source: str
    names: tuple[str, ...]


@dataclass(frozen=True)
class Wanted:
    """What is to be made besides the model itself."""

    colours: bool = True
    undistorted: bool = False


@dataclass(frozen=True)
class Scene:
    """What all reconstructions of a run share; sent to each process once.

    ``image_keys`` are hashes of the images' pixels by name. ``folder`` holds the models.
    """

    dataset: Dataset
    methods: Methods
    preset: str
    protocol: ReconstructionProtocol
    folder: Path
    image_keys: Mapping[str, str]
    cameras: tuple[CameraGroup, ...] = ()
    wanted: Wanted = Wanted()
    versions: tuple[str, str] = ("", "")

    @property
    def images(self) -> Path:
        """Where the images are as they were read, for COLMAP and others."""
        return self.folder / IMAGES

    def place(self, combination: Combination) -> Path:
        """The folder of a combination's model."""
        return self.folder / str(combination)

    def features_key(self, name: str, combination: Combination) -> str:
        """Names the features of one image."""
        parameters = self.methods.parameters(combination)
        return content_hash(
            [
                self.image_keys[name],
                parameters["detector"],
                parameters["descriptor"],
                self.protocol.matching_identity(),
                self.versions[0],
            ]
        )

    def matching_key(self, combination: Combination) -> str:
        """Names the matches of all pairs."""
        return content_hash(
            [
                self._pairs(),
                [[image.name, self.image_keys[image.name]] for image in self.dataset.images],
                self.methods.parameters(combination),
                self.protocol.matching_identity(),
                self.versions[0],
            ]
        )

    def settings_key(self) -> str:
        """Names what all combinations have in common."""
        return content_hash(
            [
                self._pairs(),
                dict(self.image_keys),
                [[group.model, group.parameters, group.names] for group in self.cameras],
                [
                    [image.name, image.truth.centre.tolist(), image.truth.rotation.tolist()]
                    for image in self.dataset.images
                    if image.truth
                ],
                self.preset,
                self.protocol.identity(),
                self.versions,
            ]
        )

    def row_key(self, combination: Combination) -> str:
        """Names a model and the files that are made of it."""
        return content_hash(
            [self.settings_key(), self.matching_key(combination), asdict(self.wanted)]
        )

    def _pairs(self) -> list[tuple[str, str]]:
        return [(pair.image_1, pair.image_2) for pair in self.dataset.pairs]
