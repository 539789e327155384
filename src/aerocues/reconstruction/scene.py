"""A scene to be reconstructed, its work, and the keys of both."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

from aerocues.datasets.dataset import Dataset
from aerocues.methods.combination import Combination
from aerocues.methods.registry import Methods
from aerocues.methods.strongest import KeypointLimit
from aerocues.pipeline.protocol import MeasurementProtocol
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

    ``image_keys`` are hashes of the images' pixels by name. ``folder`` holds the models,
    ``features`` the features of the images.
    """

    dataset: Dataset
    methods: Methods
    preset: str
    protocol: ReconstructionProtocol
    folder: Path
    features: Path
    machine: str
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

    def measurement(self) -> MeasurementProtocol:
        """How pairs of images are measured under the same seed, limit and thresholds."""
        protocol = self.protocol
        return MeasurementProtocol(
            seed=protocol.seed,
            verification=protocol.verification,
            chance=protocol.chance,
            limit=KeypointLimit(protocol.max_keypoints),
            thresholds=protocol.thresholds,
        )

    def threshold(self, combination: Combination) -> float | None:
        """The inlier threshold that the preset gives a combination, in pixels; None: the usual."""
        measurement = self.measurement()
        own = measurement.threshold(combination)
        return None if own == measurement.verification.threshold else own

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
        content = [self.settings_key(), self.matching_key(combination), asdict(self.wanted)]
        threshold = self.threshold(combination)
        return content_hash(content if threshold is None else [*content, threshold])

    def _pairs(self) -> list[tuple[str, str]]:
        return [(pair.image_1, pair.image_2) for pair in self.dataset.pairs]
