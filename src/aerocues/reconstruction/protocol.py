"""What all combinations of a scene have in common when they are reconstructed."""

from __future__ import annotations

from collections import abc
from dataclasses import asdict, dataclass, field
from typing import Literal, get_args

from aerocues.arguments import check_choice, check_positive, check_whole
from aerocues.defaults import FLIGHT_KEYPOINTS
from aerocues.pipeline.protocol import ChanceTest, Verification

Intrinsics = Literal["fixed", "refine"]
Mapper = Literal["incremental", "global"]

# Raised whenever the same images and methods would give other models.
RECONSTRUCTION_VERSION = 1


@dataclass(frozen=True)
class Requirements:
    """What a model must be, to count as a success.

    Parameters
    ----------
    registered_share : float
        Least share of the images that the largest model holds; and of those that are in their
        place, where that is known.
    position_error_share : float
        How far a camera in its place may be off, as a share of the extent of the flight.
    gps_error : float
        Metres that it may be off at least where positions are from GPS, which errs itself.
    """

    registered_share: float = 0.8
    position_error_share: float = 0.03
    gps_error: float = 5.0


@dataclass(frozen=True)
class Mapping:
    """Settings of COLMAP; the rest are its defaults.

    Bundle adjustment is called less often than by default: the same images and points within
    0.3 %, in half the time.
    """

    verification_trials: int = 1000
    smallest_model: int = 3
    most_models: int = 10
    global_adjustment_ratio: float = 1.4
    global_refinements: int = 2
    local_refinements: int = 1


@dataclass(frozen=True)
class ReconstructionProtocol:
    """How combinations are reconstructed; recorded with every model.

    Parameters
    ----------
    seed : int
        Of every stage.
    max_keypoints : int
        Strongest keypoints kept in an image; 0: all.
    intrinsics : {"fixed", "refine"}
        Whether focal length and distortion are those known before, or adjusted with the model.
        Flat scenes seen from straight above do not determine them.
    focal_length : float or None
        Pixels, in place of what EXIF tells; above 0.
    mapper : {"incremental", "global"}
    chance : ChanceTest or None
        Pairs whose matches do not beat chance are not given to COLMAP. With thousands of
        keypoints, images that share nothing have more than enough matches to be verified by
        COLMAP's rules; they cost most of the time of mapping, and some pull cameras away.
    thresholds : mapping of str to float
        Inlier thresholds in pixels of "DETECTOR-DESCRIPTOR", where a preset gives them: of the
        test against chance and of COLMAP's verification.

    Raises
    ------
    ArgumentError
        If something makes no sense: every model would fail, each after all of its work.
    """

    seed: int = 0
    max_keypoints: int = FLIGHT_KEYPOINTS
    intrinsics: Intrinsics = "fixed"
    focal_length: float | None = None
    mapper: Mapper = "incremental"
    verification: Verification = field(default_factory=Verification)
    chance: ChanceTest | None = field(default_factory=ChanceTest)
    thresholds: abc.Mapping[str, float] = field(default_factory=dict)
    mapping: Mapping = Mapping()
    requirements: Requirements = Requirements()

    def __post_init__(self) -> None:
        check_whole("seed", self.seed, 0)
        check_whole("max_keypoints", self.max_keypoints, 0)
        check_choice("intrinsics", self.intrinsics, get_args(Intrinsics))
        check_choice("mapper", self.mapper, get_args(Mapper))
        if self.focal_length is not None:
            check_positive("focal_length", self.focal_length)

    def matching_identity(self) -> dict[str, object]:
        """What decides features and matches."""
        return {
            "version": RECONSTRUCTION_VERSION,
            "seed": self.seed,
            "max_keypoints": self.max_keypoints,
        }

    def identity(self) -> dict[str, object]:
        """What decides the models of all combinations and what is said of them.

        Thresholds are of some combinations only.
        """
        settings = asdict(self)
        del settings["thresholds"]
        return {"version": RECONSTRUCTION_VERSION, **settings}
