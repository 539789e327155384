"""Pair matchers, one row each, and the rows that stand for the stages that they do without."""

from __future__ import annotations

from collections.abc import Mapping

from aerocues.methods.combination import NONE
from aerocues.methods.descriptors import DescriptorRow, DescriptorType
from aerocues.methods.detectors import DetectorRow
from aerocues.methods.matchers import MatcherRow, NormRow
from aerocues.methods.parameters import AEROCUES

NO_DESCRIPTOR = DescriptorRow(
    NONE, "", {}, "", "float32", columns=0, microseconds_per_keypoint=0, origin=AEROCUES
)
OF_PAIRS: Mapping[str, tuple[DescriptorType, ...]] = {NONE: (NO_DESCRIPTOR.dtype,)}
"""What pair matchers take: no descriptors, under no norm."""
NO_NORM = NormRow(NONE, "", "nothing is compared: images are matched as a whole")

PIXELMAP = MatcherRow(
    "PIXELMAP",
    "dense correspondence by grids of local affine maps, looked up on a regular grid",
    "Brendeloekken, PIXELMAP, TechRxiv 173749998.89779329, 2025",
    {NONE: {"quality": "low", "spacing": 8, "seed": 0}},
    OF_PAIRS,
    factory="aerocues.methods.pixelmap:PixelMap",
    of_pairs=True,
    on_request="extra",
    origin=AEROCUES,
)


def positions_of(matcher: MatcherRow) -> DetectorRow:
    """What stands for a pair matcher where other combinations have a detector."""
    return DetectorRow(
        matcher.name,
        matcher.factory,
        {},
        matcher.reference,
        seconds_per_megapixel=0.0,
        of_pairs=True,
        on_request=matcher.on_request,
        upright=matcher.upright,
        origin=matcher.origin,
        unavailable=matcher.unavailable,
    )
