"""A scene to reconstruct, the wanted outputs, and their keys."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path

from aerocues.datasets.dataset import Dataset, turns_of
from aerocues.methods.combination import Combination
from aerocues.methods.registry import Methods
from aerocues.methods.strongest import KeypointLimit
from aerocues.pipeline.protocol import MeasurementProtocol
from aerocues.reconstruction.merging import CELL
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
        In COLMAP's order and convention (the centre of the top-left pixel is (0.5, 0.5)). Empty if
        nothing is known; COLMAP then makes a guess.
    source : str
        Source of the focal length.
    names : tuple of str
    """

    model: str
    parameters: tuple[float, ...]
    source: str
    names: tuple[str, ...]


@dataclass(frozen=True)
class Wanted:
    """Outputs besides the model itself."""

    colours: bool = True
    undistorted: bool = False


@dataclass(frozen=True)
class Scene:
    """The context that all reconstructions of a run share; it is sent to each process once.

    ``image_keys`` are hashes of the images' pixels by name, ``left_out`` are images that cannot be
    read, with the reason. ``folder`` holds the models,
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
    left_out: Mapping[str, str] = field(default_factory=dict)
    cameras: tuple[CameraGroup, ...] = ()
    wanted: Wanted = Wanted()
    versions: tuple[str, str] = ("", "")

    @property
    def images(self) -> Path:
        """The folder of the measured images, for COLMAP and others."""
        return self.folder / IMAGES

    def without(self, unreadable: Mapping[str, str]) -> Scene:
        """The scene without images that cannot be read, and the pairs with them."""
        if not unreadable:
            return self
        images = [image for image in self.dataset.images if image.name not in unreadable]
        pairs = [
            pair
            for pair in self.dataset.pairs
            if pair.image_1 not in unreadable and pair.image_2 not in unreadable
        ]
        return replace(
            self,
            dataset=replace(self.dataset, images=images, pairs=pairs),
            image_keys={image.name: self.image_keys[image.name] for image in images},
            left_out={**self.left_out, **unreadable},
        )

    def place(self, combination: Combination) -> Path:
        """The folder of the model of a combination."""
        return self.folder / str(combination)

    def measurement(self) -> MeasurementProtocol:
        """The protocol of measurements with the same seed, limit and thresholds."""
        protocol = self.protocol
        return MeasurementProtocol(
            seed=protocol.seed,
            verification=protocol.verification,
            chance=protocol.chance,
            limit=KeypointLimit(protocol.max_keypoints),
            thresholds=protocol.thresholds,
        )

    def threshold(self, combination: Combination) -> float | None:
        """The inlier threshold of a combination from the preset, in pixels; None: the default."""
        measurement = self.measurement()
        own = measurement.threshold(combination)
        return None if own == measurement.verification.threshold else own

    def matching_key(self, combination: Combination) -> str:
        """Key of the matches of all pairs."""
        return content_hash(
            [
                self._pairs(),
                [[image.name, self.image_keys[image.name]] for image in self.dataset.images],
                self.parameters(combination),
                self.protocol.matching_identity(),
                self.versions[0],
            ]
        )

    def parameters(self, combination: Combination) -> dict[str, object]:
        """Everything that decides what the methods of a combination compute in a scene."""
        parameters = self.methods.parameters(combination)
        if turns := turns_of(self.dataset):
            parameters["turned"] = {name: turn for name, turn in turns.items() if turn}
        merged = combination.of_pairs and not combination.guided
        return {**parameters, "merged_within": CELL} if merged else parameters

    def settings_key(self) -> str:
        """Key of the settings that all combinations share."""
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
        """Key of a model and its files."""
        content = [self.settings_key(), self.matching_key(combination), asdict(self.wanted)]
        threshold = self.threshold(combination)
        return content_hash(content if threshold is None else [*content, threshold])

    def _pairs(self) -> list[tuple[str, str]]:
        return [(pair.image_1, pair.image_2) for pair in self.dataset.pairs]
