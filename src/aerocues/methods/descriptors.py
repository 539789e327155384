"""The descriptors of OpenCV, one row each. Parameters are those of the thesis (OpenCV 4.11)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from aerocues.methods.detectors import DETECTORS
from aerocues.methods.parameters import OPENCV, Value

DescriptorType = Literal["uint8", "float32"]
_OF_DETECTOR = {row.name: row.parameters for row in DETECTORS}
_UNBIASED = {row.name: row.unbiased for row in DETECTORS}


@dataclass(frozen=True)
class DescriptorRow:
    """One descriptor.

    Parameters
    ----------
    name, factory, parameters, reference, unbiased, on_request, upright, origin, unavailable
        As for a detector.
    dtype : {"uint8", "float32"}
        Type of the descriptor's elements.
    bit_string : bool
        Whether the bytes are strings of bits, on which only the Hamming norm means anything.
        LUCID's bytes are ranks; the thesis counts them with the bit strings and so does this table.
    microseconds_per_keypoint : float
        Typical time, used only to estimate the cost of work before it is done.
    columns : int
        Elements of one descriptor, for the same use.
    only_detectors, not_detectors : mapping of detector to reason, or tuple
        Keypoints that it needs, or that break it.
    needs_colour : bool
        Whether three different channels are needed.
    """

    name: str
    factory: str
    parameters: Mapping[str, Value] = field(repr=False)
    reference: str
    dtype: DescriptorType
    columns: int = 128
    microseconds_per_keypoint: float = 50
    only_detectors: tuple[str, ...] = ()
    not_detectors: Mapping[str, str] = field(default_factory=dict)
    needs_colour: bool = False
    unbiased: Mapping[str, Value] = field(default_factory=dict)
    on_request: str = ""
    upright: bool = False
    origin: str = OPENCV
    unavailable: str | None = None

    @property
    def bit_string(self) -> bool:
        return self.dtype == "uint8"


DESCRIPTORS: tuple[DescriptorRow, ...] = (
    DescriptorRow(
        "SIFT",
        "SIFT",
        _OF_DETECTOR["SIFT"],
        "Lowe, Distinctive image features from scale-invariant keypoints, IJCV 2004",
        "float32",
        128,
        30,
        not_detectors={
            "MSD": "MSD's octaves are deeper than the SIFT descriptor's pyramid (OpenCV asserts)"
        },
        unbiased=_UNBIASED["SIFT"],
    ),
    DescriptorRow(
        "AKAZE",
        "AKAZE",
        _OF_DETECTOR["AKAZE"],
        "Alcantarilla et al., Fast explicit diffusion for accelerated features, BMVC 2013",
        "uint8",
        61,
        30,
        only_detectors=("AKAZE", "KAZE"),
    ),
    DescriptorRow(
        "ORB",
        "ORB",
        _OF_DETECTOR["ORB"],
        "Rublee et al., ORB: an efficient alternative to SIFT or SURF, ICCV 2011",
        "uint8",
        32,
        3,
        not_detectors=dict.fromkeys(
            ("SIFT", "SIFT_COLMAP"),
            "the ORB descriptor reads SIFT's packed octave as a pyramid level and would ask for "
            "about 72 GB",
        ),
        unbiased=_UNBIASED["ORB"],
    ),
    DescriptorRow(
        "BRISK",
        "BRISK",
        _OF_DETECTOR["BRISK"],
        "Leutenegger et al., BRISK: binary robust invariant scalable keypoints, ICCV 2011",
        "uint8",
        64,
        8,
    ),
    DescriptorRow(
        "KAZE",
        "KAZE",
        _OF_DETECTOR["KAZE"],
        "Alcantarilla et al., KAZE features, ECCV 2012",
        "float32",
        64,
        100,
        only_detectors=("AKAZE", "KAZE"),
    ),
    DescriptorRow(
        "VGG",
        "VGG",
        {
            "desc": 103,
            "isigma": 1.4,
            "img_normalize": False,
            "use_scale_orientation": True,
            "scale_factor": 6.25,
            "dsc_normalize": False,
        },
        "Simonyan et al., Learning local feature descriptors using convex optimisation, TPAMI 2014",
        "float32",
        48,
        1200,
    ),
    DescriptorRow(
        "DAISY",
        "DAISY",
        {
            "radius": 15.0,
            "q_radius": 3,
            "q_theta": 8,
            "q_hist": 8,
            "norm": "DAISY.NRM_NONE",
            "interpolation": True,
            "use_orientation": False,
        },
        "Tola et al., DAISY: an efficient dense descriptor applied to wide-baseline stereo, "
        "TPAMI 2010",
        "float32",
        200,
        20,
    ),
    DescriptorRow(
        "FREAK",
        "FREAK",
        {
            "orientationNormalized": True,
            "scaleNormalized": True,
            "patternScale": 20.0,
            "nOctaves": 3,
        },
        "Alahi et al., FREAK: fast retina keypoint, CVPR 2012",
        "uint8",
        64,
        8,
    ),
    DescriptorRow(
        "BRIEF",
        "BriefDescriptorExtractor",
        {"bytes": 16, "use_orientation": True},
        "Calonder et al., BRIEF: binary robust independent elementary features, ECCV 2010",
        "uint8",
        16,
        2,
    ),
    DescriptorRow(
        "LUCID",
        "LUCID",
        {"lucid_kernel": 3, "blur_kernel": 6},
        "Ziegler et al., Locally uniform comparison image descriptor, NIPS 2012",
        "uint8",
        147,
        3,
        needs_colour=True,
    ),
    DescriptorRow(
        "LATCH",
        "LATCH",
        {"bytes": 2, "rotationInvariance": True, "half_ssd_size": 1, "sigma": 1.4},
        "Levi and Hassner, LATCH: learned arrangements of three patch codes, WACV 2016",
        "uint8",
        2,
        3,
    ),
    DescriptorRow(
        "BEBLID",
        "BEBLID",
        {"scale_factor": 6.25, "n_bits": 100},
        "Suarez et al., BEBLID: boosted efficient binary local image descriptor, PRL 2020",
        "uint8",
        64,
        10,
    ),
    DescriptorRow(
        "TEBLID",
        "TEBLID",
        {"scale_factor": 6.25, "n_bits": 102},
        "Suarez et al., Revisiting binary local image description for resource limited devices, "
        "RA-L 2021",
        "uint8",
        32,
        8,
    ),
    DescriptorRow(
        "BOOST",
        "BoostDesc",
        {"desc": 100, "use_scale_orientation": True, "scale_factor": 6.25},
        "Trzcinski et al., Boosting binary keypoint descriptors, CVPR 2013",
        "uint8",
        32,
        160,
    ),
)
