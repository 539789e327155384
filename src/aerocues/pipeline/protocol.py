"""Everything that decides a measurement besides the images and the methods."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace

from aerocues.methods.combination import Combination
from aerocues.methods.presets import Preset
from aerocues.methods.strongest import ALL_KEYPOINTS, KeypointLimit
from aerocues.results.timing import Timing

# Raised whenever the same images and methods would give other rows: old rows are then redone.
MEASUREMENT_VERSION = 3
# Rows without a reference are still those of this version.
VERSION_WITHOUT_REFERENCE = 2


@dataclass(frozen=True)
class Verification:
    """Robust estimation by MAGSAC++ (Barath et al., CVPR 2020), as OpenCV's default runs it.

    Parameters
    ----------
    threshold : float
        Inlier threshold in pixels, on the Sampson distance (fundamental matrix) or the
        reprojection error (homography).
    confidence : float
    max_iterations : int
    minimum_matches : int
        With fewer matches no model is estimated: seven points always fit one exactly.
    """

    threshold: float = 3.0
    confidence: float = 0.99
    max_iterations: int = 1000
    minimum_matches: int = 8


@dataclass(frozen=True)
class ChanceTest:
    """Asks that a model be better than those that wrong matches give.

    The second points of the matches are shuffled and verified again, `shuffles` times. A model
    passes if its inliers exceed `factor` times the largest count among the shuffled ones.

    With few right matches among many, 1000 uniform samples seldom contain one that is all right.
    A model that does not pass is therefore looked for once more with guided sampling (PROSAC, Chum
    and Matas, CVPR 2005: the matches with the smallest descriptor distance first) and passes if
    it exceeds `guided_factor` times what guided sampling finds in the shuffled matches. Where the
    images are known to show a plane or to be taken from one place, a homography, whose samples
    are smaller, is looked for last in the same way.

    Where few matches are right, shuffling does not always tell: a model is also chance if less
    than `right_share` of its inliers are right according to the reference of the two images. The
    share was at most 0.03 in models of shuffled matches, and at least 0.15 in those that hold.
    """

    shuffles: int = 5
    factor: float = 1.4
    guided_factor: float = 1.4
    homography_factor: float = 1.5
    homography_iterations: int = 5000
    right_share: float = 0.1


@dataclass(frozen=True)
class Refinement:
    """How observations of tracks are refined.

    Parameters
    ----------
    half_window, sigma : int, float
        Pixels around a keypoint that are compared, and the sigma of their weights.
    blur : float
        Sigma of the blur of the images, in pixels.
    steps : int
        Gauss-Newton steps of an observation at most.
    likeness : float
        Zero-mean normalised cross-correlation that an observation needs to be accepted.
    farthest : float
        Pixels of the features' images that it may be moved at most.
    recovery : float
        Pixels that it may be moved where it was rejected at first and starts again where its
        neighbours are sure it lies.
    neighbours : int
        Tracks around it that tell how the patch is warped.
    """

    half_window: int = 8
    sigma: float = 4.0
    blur: float = 0.5
    steps: int = 15
    likeness: float = 0.8
    farthest: float = 4.0
    recovery: float = 2.0
    neighbours: int = 12


REFINEMENT = Refinement()


@dataclass(frozen=True)
class MeasurementProtocol:
    """How combinations are measured; recorded with every result.

    ``chance`` is None where no chance test is asked for. ``timing`` is ``exclusive`` where a
    stage has the machine's core to itself, ``shared`` where several workers run at once,
    ``estimated`` where, besides, brute force is timed on a part of the descriptors. ``limit`` is
    how many keypoints of an image are kept. Where chance is asked about, so is a reference of the
    two images. ``thresholds`` has inlier thresholds in pixels of
    "DETECTOR-DESCRIPTOR" that differ from the one of ``verification``.
    """

    seed: int = 0
    timing: Timing = "shared"
    verification: Verification = Verification()
    chance: ChanceTest | None = ChanceTest()
    limit: KeypointLimit = ALL_KEYPOINTS
    thresholds: Mapping[str, float] = field(default_factory=dict)

    @classmethod
    def of_preset(
        cls,
        preset: Preset,
        *,
        seed: int = 0,
        timing: Timing = "shared",
        limit: KeypointLimit = ALL_KEYPOINTS,
    ) -> MeasurementProtocol:
        """The protocol that a preset asks for."""
        chance = ChanceTest() if preset.chance_test else None
        return cls(seed, timing, Verification(), chance, limit, preset.thresholds)

    def threshold(self, combination: Combination) -> float:
        """The inlier threshold of a combination, in pixels."""
        both = f"{combination.detector}-{combination.descriptor}"
        return self.thresholds.get(both, self.verification.threshold)

    def with_threshold(self, threshold: float) -> MeasurementProtocol:
        """The same with another inlier threshold, in pixels."""
        return replace(self, verification=replace(self.verification, threshold=threshold))

    def identity(self) -> dict[str, object]:
        """What decides the quality columns of all combinations: everything but the timing.

        Thresholds of some combinations are part of what decides their rows.
        """
        settings = asdict(self)
        del settings["timing"], settings["thresholds"]
        if not self.limit.count:
            del settings["limit"]
        version = MEASUREMENT_VERSION if self.chance else VERSION_WITHOUT_REFERENCE
        return {"measurement_version": version, **settings}
