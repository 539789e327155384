"""Methods that many use and the thesis leaves out, one row each; they take part on request."""

from __future__ import annotations

from dataclasses import replace

from aerocues.methods.descriptors import DESCRIPTORS, DescriptorRow
from aerocues.methods.detectors import DETECTORS, DetectorRow
from aerocues.methods.matchers import MatcherRow
from aerocues.methods.parameters import AEROCUES

EXTRA = "extra"
"""The set in which they are offered."""
_SIFT = next(row for row in DETECTORS if row.name == "SIFT")
_SIFT_DESCRIPTOR = next(row for row in DESCRIPTORS if row.name == "SIFT")

EXTRA_DETECTORS: tuple[DetectorRow, ...] = (
    replace(
        _SIFT,
        name="SIFT_COLMAP",
        # COLMAP's peak threshold is that of one of three layers.
        parameters={**_SIFT.parameters, "contrastThreshold": 0.02},
        reference="Schoenberger and Frahm, Structure-from-motion revisited, CVPR 2016",
        keypoints_per_megapixel=16_000,
        on_request=EXTRA,
        origin=AEROCUES,
    ),
)

EXTRA_DESCRIPTORS: tuple[DescriptorRow, ...] = (
    replace(
        _SIFT_DESCRIPTOR,
        name="ROOTSIFT",
        reference="Arandjelovic and Zisserman, Three things everyone should know to improve object "
        "retrieval, CVPR 2012",
        on_request=EXTRA,
        origin=AEROCUES,
    ),
)

EXTRA_MATCHERS: tuple[MatcherRow, ...] = (
    MatcherRow(
        "RATIO",
        "brute force, cross-checked, clearly nearer than the second nearest both ways",
        "Lowe, Distinctive image features from scale-invariant keypoints, IJCV 2004",
        {"L2": {"ratio": 0.8}, "HAM": {"ratio": 0.8}},
        {"L2": ("float32", "uint8"), "HAM": ("uint8",)},
        factory="aerocues.methods.ratio:RatioMatcher",
        on_request=EXTRA,
        origin=AEROCUES,
    ),
    MatcherRow(
        "GMS",
        "brute force, cross-checked, with enough matches around that move alike",
        "Bian et al., GMS: grid-based motion statistics, CVPR 2017",
        {
            norm: {"with_rotation": True, "with_scale": False, "threshold_factor": 6.0}
            for norm in ("L2", "HAM")
        },
        {"L2": ("float32", "uint8"), "HAM": ("uint8",)},
        factory="aerocues.methods.motion_statistics:GmsMatcher",
        on_request=EXTRA,
        origin=AEROCUES,
    ),
)
