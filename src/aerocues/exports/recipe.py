"""Everything that decides what a combination computes, as a program needs to be told it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import get_args

from aerocues.arguments import check_choice, check_whole
from aerocues.datasets.dataset import Geometry
from aerocues.datasets.fitting import check_settings
from aerocues.errors import SelectionError
from aerocues.methods.combination import Combination
from aerocues.methods.descriptors import DescriptorRow
from aerocues.methods.detectors import DetectorRow
from aerocues.methods.matchers import EXACT
from aerocues.methods.parameters import OPENCV, Value
from aerocues.methods.plugins import installed_methods
from aerocues.methods.positions import EXACT_POSITIONS, GRAY_INPUT, PYRAMIDS, Pyramid
from aerocues.methods.presets import Preset
from aerocues.methods.selection import select_one
from aerocues.methods.strongest import keypoint_limit
from aerocues.pipeline.protocol import ChanceTest, MeasurementProtocol

BRUTE_FORCE = "BF"


@dataclass(frozen=True)
class Measured:
    """How images are read, features limited and models judged; what `run` records.

    Parameters
    ----------
    preset : Preset
    max_keypoints : int
        0 for all.
    spread : bool
        Whether the strongest of each part of the image are kept.
    seed : int
    geometry : {"epipolar", "homography"}
    max_width : int or None
        Pixels to which wider images are shrunk.
    equalize : {"none", "histogram", "clahe"}
    """

    preset: Preset
    max_keypoints: int = 0
    spread: bool = False
    seed: int = 0
    geometry: Geometry = "epipolar"
    max_width: int | None = None
    equalize: str = "none"

    def __post_init__(self) -> None:
        check_whole("seed", self.seed, 0)
        check_settings(self.max_width, self.equalize)
        check_choice("geometry", self.geometry, get_args(Geometry))


@dataclass(frozen=True)
class Attempt:
    """One look for a model: see `aerocues.pipeline.verification`.

    Parameters
    ----------
    homography, guided : bool
    iterations : int
    factor : float
        Its inliers must exceed so many times the most that shuffled matches have.
    """

    homography: bool
    guided: bool
    iterations: int
    factor: float


@dataclass(frozen=True)
class Recipe:
    """A combination with all of its parameters.

    Parameters
    ----------
    combination : Combination
    detector, descriptor : DetectorRow, DescriptorRow
        With the parameters of the preset.
    matcher : mapping
        Parameters of the index and the search of FLANN; empty for brute force.
    protocol : MeasurementProtocol
        With the inlier threshold of the combination.
    measured : Measured
    """

    combination: Combination
    detector: DetectorRow
    descriptor: DescriptorRow
    matcher: Mapping[str, Value]
    protocol: MeasurementProtocol
    measured: Measured

    @property
    def brute_force(self) -> bool:
        """Whether matches are those of brute force."""
        return self.combination.matcher in (BRUTE_FORCE, EXACT.name)

    @property
    def gray(self) -> bool:
        """Whether the detector gets the image in gray."""
        return bool(self.detector.parameters.get(GRAY_INPUT))

    @property
    def shifted(self) -> Pyramid | None:
        """The pyramid whose keypoints the detector shifts, where that is corrected."""
        exact = self.detector.parameters.get(EXACT_POSITIONS)
        return PYRAMIDS[self.detector.factory] if exact else None

    @property
    def told(self) -> bool:
        """Whether the descriptor is told other positions, to look at the right ones."""
        return bool(self.descriptor.parameters.get(EXACT_POSITIONS))

    @property
    def shuffles(self) -> int:
        """Shuffled sets of matches that a model must beat; 0 without a test against chance."""
        return self.protocol.chance.shuffles if self.protocol.chance else 0

    def attempts(self) -> tuple[Attempt, ...]:
        """The attempts to find a model, in order."""
        iterations, chance = self.protocol.verification.max_iterations, self.protocol.chance
        if chance is None:
            return (Attempt(False, False, iterations, 0.0),)
        return _attempts(chance, iterations, self.measured.geometry)


def _attempts(chance: ChanceTest, iterations: int, geometry: Geometry) -> tuple[Attempt, ...]:
    found = (
        Attempt(False, False, iterations, chance.factor),
        Attempt(False, True, iterations, chance.guided_factor),
    )
    if geometry != "homography":
        return found
    last = Attempt(True, True, chance.homography_iterations, chance.homography_factor)
    return (*found, last)


def recipe_of(combination: str | Combination, measured: Measured) -> Recipe:
    """The recipe of one combination.

    Raises
    ------
    SelectionError
        If there is no such combination, or OpenCV alone cannot do it.
    """
    limit = keypoint_limit(measured.max_keypoints, spread=measured.spread)
    methods = limit.limited(installed_methods().with_preset(measured.preset))
    one = select_one(methods, combination)
    protocol = MeasurementProtocol.of_preset(measured.preset, seed=measured.seed, limit=limit)
    detector = methods.detectors[one.detector]
    descriptor = methods.descriptor_on(one.descriptor, one.detector)
    matcher = methods.matchers[one.matcher]
    foreign = [row.name for row in (detector, descriptor, matcher) if row.origin != OPENCV]
    if foreign and foreign != [EXACT.name]:
        raise SelectionError(
            f"{foreign[0]} is not a method of OpenCV, so that a program in OpenCV alone cannot use "
            "it; choose another combination, or export its features and matches with "
            '`target="colmap"`'
        )
    return Recipe(
        one,
        detector,
        descriptor,
        matcher.parameters.get(one.norm, {}),
        protocol.with_threshold(protocol.threshold(one)),
        measured,
    )
