"""One combination from images to features, matches and a verified geometry."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TypeVar, get_args

import numpy as np
from numpy.typing import NDArray

from aerocues.arguments import check_choice, check_whole
from aerocues.datasets.dataset import Geometry, Image
from aerocues.datasets.decoded import DecodedSource, pixels_of
from aerocues.datasets.decoding import FileSource
from aerocues.datasets.file_sources import sources_alike
from aerocues.errors import MethodFailedError
from aerocues.methods.arrays import Features, Matches
from aerocues.methods.combination import Combination
from aerocues.methods.plugins import installed_methods
from aerocues.methods.presets import Preset, as_preset
from aerocues.methods.selection import select_one
from aerocues.methods.strongest import keypoint_limit
from aerocues.pipeline.clock import Clock
from aerocues.pipeline.feature_source import FeatureSource
from aerocues.pipeline.features import StageError, unless_failed
from aerocues.pipeline.pair_stages import PairStages, matched_points
from aerocues.pipeline.protocol import MeasurementProtocol
from aerocues.pipeline.verification import Verdict
from aerocues.pipeline.whole_images import MatchedPair

Result = TypeVar("Result")
ImageLike = str | Path | NDArray[np.uint8] | Image
"""An image file, a (H, W, 3) BGR or (H, W) gray uint8 array, or an image of a dataset."""


class Pipeline:
    """One combination of detector, descriptor, norm and matcher, as it is measured.

    Two pipelines with the same arguments give the same arrays.

    Parameters
    ----------
    combination : str or Combination
        Such as ``"ORB-BEBLID-HAM-BF"``, in any case.
    preset : str or Preset
        Parameters of the methods, inlier thresholds and whether models must beat chance; or the
        file of a preset.
    max_keypoints : int
        The strongest keypoints that are kept in an image; 0 keeps all.
    seed : int
        Set before every call of OpenCV.
    geometry : {"epipolar", "homography"}
        ``homography`` where the images show a plane or are taken from one place: where no
        fundamental matrix beats chance, a homography is tried, too.

    Raises
    ------
    ArgumentError
        If an argument makes no sense.
    SelectionError
        If there is no such combination or preset, or the combination cannot run here.
    """

    def __init__(
        self,
        combination: str | Combination,
        preset: str | Preset = "default",
        *,
        max_keypoints: int = 0,
        seed: int = 0,
        geometry: Geometry = "epipolar",
    ) -> None:
        check_whole("seed", seed, 0)
        check_choice("geometry", geometry, get_args(Geometry))
        parts, limit = as_preset(preset), keypoint_limit(max_keypoints)
        methods = limit.limited(installed_methods().with_preset(parts))
        protocol = MeasurementProtocol.of_preset(parts, seed=seed, limit=limit)
        clock = Clock(seed)
        self.combination = select_one(methods, combination)
        self._source = FeatureSource(methods, protocol, clock)
        self._stages = PairStages(methods, protocol, geometry, clock)

    def features(self, image: ImageLike) -> Features:
        """The keypoints that the descriptor describes, and their descriptors.

        Parameters
        ----------
        image : path, (H, W, 3) or (H, W) uint8 array, or Image
            Blue, green, red, or gray.

        Returns
        -------
        Features
            ``keypoints.xy`` is (N, 2) float32, pixels, with the centre of the top-left pixel at
            (0, 0); ``descriptors`` is (N, D) uint8 or float32.

        Raises
        ------
        ImageError
            If the image cannot be read, or the array is none of an image.
        MethodFailedError
            If the detector or the descriptor fails on it.
        """
        if self.combination.of_pairs:
            raise MethodFailedError(
                f"{self.combination.matcher} is a pair matcher, which finds nothing in a single "
                "image; give both to `match_images`"
            )
        [in_memory] = decoded(image)
        return self._run(lambda: self._features(in_memory))

    def match_images(
        self, image_1: ImageLike, image_2: ImageLike
    ) -> tuple[Features, Features, Matches]:
        """Features and matches of two images, whatever the combination, pair matchers included.

        Returns
        -------
        tuple of Features, Features and Matches
            Those of a pair matcher have no descriptors, and match one to one in their order.

        Raises
        ------
        ImageError
            If an image cannot be read, or an array is none of an image.
        MethodFailedError
            If a method fails on them.
        """
        first, second = decoded(image_1, image_2)
        if self.combination.of_pairs:
            found = self._run(lambda: self._match_pair(first, second))
            return *found.features, found.matches
        features = self.features(first), self.features(second)
        return *features, self.match(*features)

    def match(self, first: Features, second: Features) -> Matches:
        """Mutual matches of two images.

        Returns
        -------
        Matches
            ``indices`` is (M, 2) int32: keypoints of the first and of the second image;
            ``distance`` is (M,) float32, of their descriptors.

        Raises
        ------
        MethodFailedError
            If the matcher fails.
        """
        if not len(first) or not len(second):
            return Matches()
        return self._run(
            lambda: self._stages.match(self.combination, (first, second), "two images")[0]
        )

    def verify(self, first: Features, second: Features, matches: Matches) -> Verdict:
        """The geometry that matches agree on.

        Returns
        -------
        Verdict
            ``model.matrix`` is (3, 3) float64 or None, ``model.inliers`` (M,) bool in the order of
            `matches`; ``passed`` tells whether the model beats chance, where the preset asks that.

        Raises
        ------
        MethodFailedError
            If OpenCV refuses the points.
        """
        points, order = matched_points(first, second, matches)
        verdict = self._run(
            lambda: self._stages.verify(self.combination, points, order, "two images")
        )
        return verdict or Verdict.too_few(len(matches))

    def _features(self, image: Image) -> Features:
        try:
            return self._source.features(image, self.combination).features
        finally:
            self._source.forget()

    def _match_pair(self, first: Image, second: Image) -> MatchedPair:
        seen = [self._source.detected(each, self.combination.detector) for each in (first, second)]
        self._source.forget()
        one, other = map(unless_failed, seen)
        return self._stages.match_images(self.combination, (one, other), "two images")[0]

    def _run(self, call: Callable[[], Result]) -> Result:
        try:
            return call()
        except StageError as error:
            raise MethodFailedError(error.message or error.status) from error


def decoded(*images: ImageLike) -> list[Image]:
    """Images in memory, files read alike: what is wrong with a file is told as such."""
    paths = [Path(image) for image in images if isinstance(image, str | Path)]
    sources = iter(sources_alike(paths))
    return [_decoded(next(sources) if isinstance(each, str | Path) else each) for each in images]


def _decoded(image: FileSource | NDArray[np.uint8] | Image) -> Image:
    if isinstance(image, Image):
        return Image(image.name, DecodedSource(image.read()), turn=image.turn)
    if isinstance(image, FileSource):
        return Image(image.path.name, DecodedSource(image.read()))
    return Image("the image", DecodedSource(pixels_of(image)))
