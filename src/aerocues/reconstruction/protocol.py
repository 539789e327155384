"""Settings that all reconstructions of a scene share."""

from __future__ import annotations

from collections import abc
from dataclasses import asdict, dataclass, field
from typing import Literal, get_args

from aerocues.arguments import check_choice, check_positive, check_whole
from aerocues.datasets.fitting import SMALLEST
from aerocues.defaults import FLIGHT_KEYPOINTS
from aerocues.pipeline.protocol import ChanceTest, Refinement, Verification

Intrinsics = Literal["calibrated", "fixed", "refine"]
Mapper = Literal["incremental", "global"]

# Raise this whenever the same images and methods would give other models.
RECONSTRUCTION_VERSION = 2


@dataclass(frozen=True)
class Requirements:
    """Requirements for a model to count as a success.

    Parameters
    ----------
    registered_share : float
        Minimum share of the images in the largest model; and, if positions are known, minimum share
        of its images that are correctly placed.
    position_error_share : float
        Largest position error of a correctly placed camera, as a share of the extent of the flight.
    gps_error, gps_height_error : float
        With GPS positions, which have errors themselves, this horizontal and this vertical error in
        metres are always allowed.
    agreement : float
        Models agree if their cameras are this close, as a share of the extent.
    voters : int
        Minimum number of models, with at least two detectors, that can outvote GPS.
    """

    registered_share: float = 0.8
    position_error_share: float = 0.03
    gps_error: float = 5.0
    gps_height_error: float = 10.0
    agreement: float = 0.01
    voters: int = 3


@dataclass(frozen=True)
class Mapping:
    """Settings of COLMAP; all others have their defaults.

    Bundle adjustment runs less often than by default: half the time for the same images and 0.3 %
    difference in points.
    """

    verification_trials: int = 1000
    smallest_model: int = 3
    most_models: int = 10
    global_adjustment_ratio: float = 1.4
    global_refinements: int = 2
    local_refinements: int = 1


@dataclass(frozen=True)
class ErrorLimit:
    """How far from its keypoint a point may be projected by the mapper; COLMAP allows 4 px to all.

    Parameters
    ----------
    factor : float
        By the measured error of a coordinate of the keypoints.
    least, most : float
        Pixels that are allowed in any case, and at most.
    """

    factor: float = 2.0
    least: float = 1.0
    most: float = 4.0

    def pixels(self, keypoint_error: float | None) -> float:
        """The limit for keypoints of this error, which is None where it is not known."""
        if keypoint_error is None:
            return self.most
        return min(max(self.factor * keypoint_error, self.least), self.most)


@dataclass(frozen=True)
class ReconstructionProtocol:
    """How combinations are reconstructed; recorded with every model.

    Parameters
    ----------
    seed : int
        Seed of every stage.
    max_keypoints : int
        Maximum number of keypoints per image; 0: all.
    intrinsics : {"calibrated", "fixed", "refine"}
        ``calibrated``: focal length and distortion of all models are estimated once, by COLMAP's
        default, if the images determine them. ``fixed``: they stay at known values. ``refine``:
        they are adjusted with each model. Flat scenes seen from straight above do not determine
        them.
    focal_length : float or None
        Pixels, in place of the value from EXIF; above 0.
    mapper : {"incremental", "global"}
    chance : ChanceTest or None
        Pairs whose matches do not beat chance are not given to COLMAP. With thousands of keypoints,
        images without overlap have enough matches to pass COLMAP's own verification. Such pairs
        take most of the mapping time, and some of them displace cameras.
    features_width : int or None
        Features are found in images shrunk to this width in pixels; None: at full width.
    refinement : Refinement or None
        How keypoints of tracks are refined before COLMAP gets them; None: not at all.
    error_limit : ErrorLimit or None
        None leaves the mapper its own.
    thresholds : mapping of str to float
        Inlier thresholds in pixels of "DETECTOR-DESCRIPTOR" from a preset, for the chance test and
        for COLMAP's verification.

    Raises
    ------
    ArgumentError
        If something makes no sense: every model would fail, each after all of its work.
    """

    seed: int = 0
    max_keypoints: int = FLIGHT_KEYPOINTS
    intrinsics: Intrinsics = "calibrated"
    focal_length: float | None = None
    mapper: Mapper = "incremental"
    verification: Verification = field(default_factory=Verification)
    chance: ChanceTest | None = field(default_factory=ChanceTest)
    refinement: Refinement | None = field(default_factory=Refinement)
    error_limit: ErrorLimit | None = field(default_factory=ErrorLimit)
    features_width: int | None = None
    thresholds: abc.Mapping[str, float] = field(default_factory=dict)
    mapping: Mapping = Mapping()
    requirements: Requirements = Requirements()

    def __post_init__(self) -> None:
        check_whole("seed", self.seed, 0)
        check_whole("max_keypoints", self.max_keypoints, 0)
        check_choice("intrinsics", self.intrinsics, get_args(Intrinsics))
        check_choice("mapper", self.mapper, get_args(Mapper))
        if self.features_width is not None:
            check_whole("features_width", self.features_width, SMALLEST)
        if self.focal_length is not None:
            check_positive("focal_length", self.focal_length)

    def matching_identity(self) -> dict[str, object]:
        """Settings that features and matches depend on."""
        settings: dict[str, object] = {
            "version": RECONSTRUCTION_VERSION,
            "seed": self.seed,
            "max_keypoints": self.max_keypoints,
        }
        width = self.features_width
        return settings if width is None else {**settings, "features_width": width}

    def identity(self) -> dict[str, object]:
        """Settings that the models of all combinations and their evaluation depend on.

        Thresholds are not included, as they concern only some combinations; nor is the source of
        the intrinsics, as the cameras show them.
        """
        settings = asdict(self)
        for name in ("thresholds", "intrinsics"):
            del settings[name]
        for name in ("refinement", "error_limit", "features_width"):
            if settings[name] is None:
                del settings[name]
        return {"version": RECONSTRUCTION_VERSION, "refined": self.refined, **settings}

    @property
    def refined(self) -> bool:
        """Whether the mapper adjusts the intrinsics of each model."""
        return self.intrinsics == "refine"
