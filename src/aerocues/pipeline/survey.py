"""A quick look at the images of a flight: which ones overlap, how much, and how they are turned."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.dataset import Image
from aerocues.datasets.decoded import DecodedSource
from aerocues.datasets.fitting import shrink
from aerocues.errors import ImageError
from aerocues.methods.arrays import Features
from aerocues.methods.combination import Combination
from aerocues.methods.exact.availability import why_not_exact
from aerocues.methods.presets import Preset
from aerocues.methods.registry import opencv_methods
from aerocues.methods.strongest import KeypointLimit
from aerocues.pipeline.candidates import candidate_pairs
from aerocues.pipeline.clock import Clock
from aerocues.pipeline.feature_source import FeatureSource
from aerocues.pipeline.features import StageError
from aerocues.pipeline.pair_stages import PairStages, matched_points
from aerocues.pipeline.protocol import ChanceTest, MeasurementProtocol, Verification
from aerocues.pipeline.verification import estimate_homography, magsac_parameters
from aerocues.results.pair_classes import PairClass, pair_class

WIDTH = 640
"""Pixels to which images are shrunk: enough to tell which of them overlap."""
LIMIT = KeypointLimit(1200)
# SIFT turns with the image and finds something in nearly every scene at this threshold.
PRESET = Preset(
    "survey",
    "a quick look at a flight",
    chance_test=True,
    detectors={"SIFT": {"contrastThreshold": 0.0133}},
)
# Takes out the large motion; relief lies off the plane.
PLANE = Verification(threshold=5.0, confidence=0.999, max_iterations=2000)
# Few shuffles: most candidates of a survey do not overlap, and each costs all of them.
CHANCE = ChanceTest(shuffles=3)
FEWEST_INLIERS = 12
GRID = 16


@dataclass(frozen=True)
class SurveyedPair:
    """Two images that show the same things.

    Parameters
    ----------
    image_1, image_2 : int
        Positions among the images, in their order.
    inliers : int
        Matches that one geometry explains.
    overlap : float
        Share of image 1 that image 2 shows, 0 to 1, by a homography.
    rotation : float
        Degrees clockwise, -180 to 180, by which image 2 is turned against image 1.
    scale : float
        Size of things in image 2 over their size in image 1.
    """

    image_1: int
    image_2: int
    inliers: int
    overlap: float
    rotation: float
    scale: float

    @property
    def turn(self) -> float:
        """Degrees, 0 to 180, by which the images are turned against each other."""
        return abs(self.rotation)

    @property
    def kind(self) -> PairClass:
        """Whether the images are turned against each other."""
        return pair_class(self.turn)


@dataclass(frozen=True)
class Survey:
    """What a quick look at images found.

    Parameters
    ----------
    images : tuple of str
        In the order of the flight.
    candidates : tuple of tuple of int
        Pairs of positions that were looked at.
    pairs : tuple of SurveyedPair
        Those that show the same things.
    unreadable : mapping of str to str
        Images that cannot be read, with the reason.
    """

    images: tuple[str, ...]
    candidates: tuple[tuple[int, int], ...]
    pairs: tuple[SurveyedPair, ...]
    unreadable: tuple[tuple[str, str], ...] = ()

    def partners(self) -> NDArray[np.int64]:
        """(N,) with how many others each image overlaps."""
        counts = np.zeros(len(self.images), np.int64)
        for pair in self.pairs:
            counts[[pair.image_1, pair.image_2]] += 1
        return counts


class Surveyor:
    """Finds which of some images overlap, with few features of small versions of them.

    Parameters
    ----------
    images : sequence of Image
        In the order of the flight.
    seed : int
    """

    def __init__(self, images: Sequence[Image], seed: int = 0) -> None:
        methods = LIMIT.limited(opencv_methods().with_preset(PRESET))
        protocol = MeasurementProtocol(seed=seed, chance=CHANCE, limit=LIMIT)
        matcher = "FLANN" if why_not_exact() else "EXACT"
        self._combination = Combination("SIFT", "SIFT", "L2", matcher)
        self._images = images
        self._seed = seed
        self._source = FeatureSource(methods, protocol, Clock(seed))
        self._stages = PairStages(methods, protocol, "epipolar", Clock(seed))
        self._sizes: dict[int, tuple[int, int]] = {}

    def survey(self, progress: Callable[[int, int], None] = lambda done, total: None) -> Survey:
        """Look at the images, then at the pairs of them that may overlap.

        Parameters
        ----------
        progress : callable
            Called with how many images and pairs of how many are done; the total is not final
            until all images are read.
        """
        features, unreadable = self._features(progress)
        readable = sorted(features)
        candidates = candidate_pairs(
            [self._images[number].gps for number in readable],
            [features[number] for number in readable],
        )
        named = [(readable[first], readable[second]) for first, second in candidates]
        total = len(self._images) + len(named)
        found = []
        for done, (first, second) in enumerate(named, start=len(self._images) + 1):
            pair = self._look_at(first, second, features)
            if pair is not None:
                found.append(pair)
            progress(done, total)
        names = tuple(image.name for image in self._images)
        return Survey(names, tuple(named), tuple(found), tuple(unreadable))

    def _features(
        self, progress: Callable[[int, int], None]
    ) -> tuple[dict[int, Features], list[tuple[str, str]]]:
        features, unreadable = {}, []
        for number, image in enumerate(self._images):
            try:
                small = shrink(image.read(), WIDTH)
                self._sizes[number] = (small.bgr.shape[1], small.bgr.shape[0])
                decoded = Image(image.name, DecodedSource(small))
                features[number] = self._source.features(decoded, self._combination).features
            except (ImageError, StageError) as error:
                unreadable.append((image.name, str(error)))
            self._source.forget()
            progress(number + 1, len(self._images))
        return features, unreadable

    def _look_at(
        self, first: int, second: int, features: dict[int, Features]
    ) -> SurveyedPair | None:
        """What two images share; None where they show nothing in common."""
        both = features[first], features[second]
        if not all(len(each) for each in both):
            return None
        try:
            matches, _ = self._stages.match(self._combination, both, "two images")
            points, order = matched_points(*both, matches)
            verdict = self._stages.verify(self._combination, points, order, "two images")
        except StageError:
            return None  # a survey needs no pair in particular; measuring it will say what is wrong
        if verdict is None or not verdict.passed or verdict.model.count < FEWEST_INLIERS:
            return None
        kept = verdict.model.inliers
        plane = estimate_homography(
            points[0][kept], points[1][kept], magsac_parameters(PLANE, seed=self._seed)
        )
        if plane.matrix is None:
            return None
        seen = view_change(plane.matrix, self._sizes[first], self._sizes[second])
        if seen is None:
            return None
        return SurveyedPair(first, second, verdict.model.count, *seen)


def view_change(
    homography: NDArray[np.float64], size_1: tuple[int, int], size_2: tuple[int, int]
) -> tuple[float, float, float] | None:
    """Overlap, clockwise rotation in degrees and scale of two images that a homography relates.

    Parameters
    ----------
    homography : (3, 3) float64
        Maps pixels of image 1 to pixels of image 2.
    size_1, size_2 : tuple of int
        Widths and heights.

    Returns
    -------
    tuple of float or None
        None where the images would not overlap, or the homography mirrors the picture: it is then
        not that of two views.
    """
    width, height = size_1
    columns, rows = (np.arange(GRID) + 0.5) * width / GRID, (np.arange(GRID) + 0.5) * height / GRID
    grid = np.stack(np.meshgrid(columns, rows), axis=-1).reshape(-1, 2)
    moved = np.column_stack([grid, np.ones(len(grid))]) @ homography.T
    ahead = moved[:, 2] * np.sign(moved[:, 2].sum()) > 0
    with np.errstate(divide="ignore", invalid="ignore"):
        at = moved[:, :2] / moved[:, 2:]
    inside = ahead & (at >= 0).all(axis=1) & (at < size_2).all(axis=1)
    if not inside.any():
        return None
    # The derivative at the middle of what both images show.
    centre = np.append(grid[inside].mean(axis=0), 1.0)
    x, y, z = homography @ centre
    slope = (homography[:2, :2] - np.outer((x / z, y / z), homography[2, :2])) / z
    area = float(np.linalg.det(slope))
    if area <= 0:
        return None
    rotation = math.degrees(math.atan2(slope[1, 0] - slope[0, 1], slope[0, 0] + slope[1, 1]))
    return float(inside.mean()), rotation, math.sqrt(area)
