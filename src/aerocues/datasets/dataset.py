"""Datasets: images, pairs of images and their ground truth."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import astuple, dataclass, replace
from functools import cached_property
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

Geometry = Literal["homography", "epipolar"]


@dataclass(frozen=True, eq=False)
class Pixels:
    """A decoded image.

    Parameters
    ----------
    bgr : (H, W, 3) uint8
        Blue, green, red; a gray source has three equal channels.
    valid : (H, W) bool or None
        False where the image has no content (the border of a warp); None: all valid.
    """

    bgr: NDArray[np.uint8]
    valid: NDArray[np.bool_] | None = None


class ImageSource(Protocol):
    """The source of an image: a file, or a transformation of another source."""

    def read(self) -> Pixels:
        """Decode the image.

        Raises
        ------
        ImageError
            If it cannot be decoded completely.
        """

    def content_key(self) -> str:
        """Hexadecimal hash of the content and of everything that changes the pixels."""

    def is_gray(self) -> bool:
        """Whether the source has a single channel, by its header; False if that is broken."""


@dataclass(frozen=True)
class GpsPosition:
    """A WGS84 position: latitude and longitude in degrees, altitude in metres."""

    latitude: float
    longitude: float
    altitude: float | None = None


class DepthSource(Protocol):
    """The source of the true depth of an image."""

    def read(self) -> NDArray[np.float32]:
        """Planar depth: (H, W) float32 metres along the viewing axis.

        Infinite in the sky, NaN where unknown.

        Raises
        ------
        ImageError
            If it cannot be read.
        """

    def content_key(self) -> str:
        """Hexadecimal hash of the depth and of the size at which it is read."""


@dataclass(frozen=True)
class PinholeCamera:
    """A camera without distortion, in pixels; the centre of the top-left pixel is (0, 0)."""

    width: int
    height: int
    focal_x: float
    focal_y: float
    centre_x: float
    centre_y: float


@dataclass(frozen=True, eq=False)
class TrueView:
    """The ground truth of an image.

    Parameters
    ----------
    camera : PinholeCamera
    rotation : (3, 3) float64
        From the world (x east, y north, z up) to the camera: x right, y down, z forward.
    centre : (3,) float64
        Centre of the camera in the world, metres.
    depth : DepthSource or None
    """

    camera: PinholeCamera
    rotation: NDArray[np.float64]
    centre: NDArray[np.float64]
    depth: DepthSource | None = None

    def identity(self) -> list[object]:
        """The ground truth in JSON types; the depth as its hash."""
        depth = None if self.depth is None else self.depth.content_key()
        return [*astuple(self.camera), self.rotation.tolist(), self.centre.tolist(), depth]


@dataclass(frozen=True, eq=False)
class Image:
    """One image of a dataset; pixels are decoded on demand.

    ``name`` is unique in its dataset (a path relative to it, with ``/``). ``turn`` is by how many
    degrees counterclockwise, 0, 90, 180 or 270, it is turned while features are found in it; None
    where nobody asked for that. Positions are those of the image as it is. ``yaw`` is where its top
    points, degrees clockwise from north, by its metadata.
    """

    name: str
    source: ImageSource
    gps: GpsPosition | None = None
    truth: TrueView | None = None
    turn: int | None = None
    yaw: float | None = None

    def read(self) -> Pixels:
        return self.source.read()

    def features_key(self) -> str | list[object]:
        """What of the image decides its features: its content, and how it is turned."""
        key = self.source.content_key()
        return [key, self.turn] if self.turn else key


@dataclass(frozen=True, eq=False)
class Pair:
    """Two images to match.

    Parameters
    ----------
    index : int
        0-based index among the pairs of the whole dataset; subsets keep it.
    image_1, image_2 : str
        Names of the images.
    sequence : str
        Scene, sequence, project or kind of transformation of the pair.
    homography : (3, 3) float64 or None
        Maps pixels of image 1 to pixels of image 2 (pixel centres at integers), at the size of the
        images as read.
    """

    index: int
    image_1: str
    image_2: str
    sequence: str
    homography: NDArray[np.float64] | None = None


@dataclass(frozen=True)
class Source:
    """The arguments of `open_dataset`, to open the same images again.

    Parameters
    ----------
    spec : str
        Text form of the dataset, with an absolute path.
    pairs, max_width, equalize, max_pairs, sequences, subset, band, every
        See `open_dataset`; the names of sequences as one text.
    """

    spec: str
    pairs: str | None = None
    max_width: int | None = None
    equalize: str = "none"
    max_pairs: int | None = None
    sequences: str | None = None
    subset: str | None = None
    band: int | None = None
    every: float | None = None


@dataclass(frozen=True, eq=False)
class Dataset:
    """Images, and the pairs of images to match.

    Parameters
    ----------
    name : str
    images : sequence of Image
        Decoded on demand.
    pairs : sequence of Pair
    geometry : {"homography", "epipolar"}
        What relates two images: a homography (plane or rotation) or epipolar geometry.
    settings : tuple of (str, str)
        How the dataset was made: pairs, size, equalisation, range of values.
    source : Source or None
        How to open it again, if known; no measurement depends on it.
    notes : tuple of str
        Which files were left out, and what looks odd among the images.
    """

    name: str
    images: Sequence[Image]
    pairs: Sequence[Pair]
    geometry: Geometry
    settings: tuple[tuple[str, str], ...] = ()
    source: Source | None = None
    notes: tuple[str, ...] = ()

    def __repr__(self) -> str:
        images, pairs = len(self.images), len(self.pairs)
        return f"Dataset {self.name}: {images:,} images, {pairs:,} pairs, {self.geometry}"

    def image(self, name: str) -> Image:
        """The image called `name`; KeyError if there is none."""
        return self._by_name[name]

    def pair(self, index: int) -> Pair:
        """The pair whose ``index`` is `index`; KeyError if there is none."""
        return self._by_index[index]

    def true_views(self, pair: Pair) -> tuple[TrueView, TrueView] | None:
        """The ground truth of both images of a pair; None unless both have one."""
        first, second = self.image(pair.image_1).truth, self.image(pair.image_2).truth
        return None if first is None or second is None else (first, second)

    @cached_property
    def _by_index(self) -> dict[int, Pair]:
        return {pair.index: pair for pair in self.pairs}

    @cached_property
    def _by_name(self) -> dict[str, Image]:
        return {image.name: image for image in self.images}


def turns_of(dataset: Dataset) -> dict[str, int]:
    """By how many degrees images are turned while features are found, by name; empty if not."""
    return {image.name: image.turn for image in dataset.images if image.turn is not None}


def with_turns(dataset: Dataset, turns: Mapping[str, int]) -> Dataset:
    """The dataset with images that are turned while features are found in them."""
    images = [replace(image, turn=turns.get(image.name)) for image in dataset.images]
    return replace(dataset, images=images)
