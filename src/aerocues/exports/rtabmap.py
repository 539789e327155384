"""Settings of RTAB-Map, whose features are a fixed list."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from aerocues.exports.nearest import Kind, nearest
from aerocues.exports.recipe import Measured, Recipe, recipe_of
from aerocues.methods.combination import Combination
from aerocues.methods.descriptors import DescriptorRow
from aerocues.methods.detectors import DetectorRow
from aerocues.methods.parameters import Value

FEATURES: Mapping[Kind, int] = {
    ("SIFT", "SIFT"): 1,
    ("ORB", "ORB"): 2,
    ("FAST", "FREAK"): 3,
    ("FAST", "BRIEF"): 4,
    ("GFTT", "FREAK"): 5,
    ("GFTT_H", "FREAK"): 5,
    ("GFTT", "BRIEF"): 6,
    ("GFTT_H", "BRIEF"): 6,
    ("BRISK", "BRISK"): 7,
    ("GFTT", "ORB"): 8,
    ("GFTT_H", "ORB"): 8,
    ("KAZE", "KAZE"): 9,
    ("GFTT", "DAISY"): 13,
    ("GFTT_H", "DAISY"): 13,
}
"""Values of ``Vis/FeatureType`` and ``Kp/DetectorStrategy``."""

GROUPS: Mapping[str, str] = {
    "SIFT": "SIFT",
    "ORB": "ORB",
    "BRISK": "BRISK",
    "KAZE": "KAZE",
    "FastFeatureDetector": "FAST",
    "GFTTDetector": "GFTT",
    "BriefDescriptorExtractor": "BRIEF",
    "FREAK": "FREAK",
}
"""Groups of parameters by the class of OpenCV."""
OTHERWISE: Mapping[str, str | None] = {
    "nlevels": "NLevels",
    "enable_precise_upscale": "PreciseUpscale",
    "nfeatures": None,
    "maxCorners": None,
    "type": None,
    "fastThreshold": None,
    "use_orientation": None,
    "exact_positions": None,
}
"""Parameters that it calls differently, or does not have; it writes others with a capital."""
CONSTANTS: Mapping[str, int] = {
    "ORB.HARRIS_SCORE": 0,
    "ORB.FAST_SCORE": 1,
    "KAZE.DIFF_PM_G1": 0,
    "KAZE.DIFF_PM_G2": 1,
    "KAZE.DIFF_WEICKERT": 2,
    "KAZE.DIFF_CHARBONNIER": 3,
}
TREES, HASHES, CROSS_CHECKED = 1, 2, 5
"""Values of ``Vis/CorNNType``."""


def rtabmap_settings(wanted: Combination, measured: Measured, ranked: Sequence[str] | None) -> str:
    """Arguments for RTAB-Map, one a line; a comment tells how near they come."""
    found = nearest(wanted, FEATURES, ranked)
    recipe = recipe_of(found.combination, measured)
    lines = [f"# {found.combination} in RTAB-Map"]
    if found.reason:
        lines = [
            f"# RTAB-Map has no {wanted.detector} with {wanted.descriptor}.",
            f"# Nearest is {found.combination}: {found.reason}.",
        ]
    lines += [f"--{name} {value}" for name, value in _settings(recipe)]
    return "".join(f"{line}\n" for line in lines)


def _settings(recipe: Recipe) -> Iterator[tuple[str, str]]:
    one = recipe.combination
    feature = FEATURES[one.detector, one.descriptor]
    yield "Vis/FeatureType", str(feature)
    yield "Kp/DetectorStrategy", str(feature)
    yield "Vis/MaxFeatures", str(recipe.protocol.limit.count)
    approximate = TREES if recipe.descriptor.dtype == "float32" else HASHES
    yield "Vis/CorNNType", str(CROSS_CHECKED if recipe.brute_force else approximate)
    written = dict(_parameters(recipe.detector))
    written.update(_parameters(recipe.descriptor))
    yield from written.items()


def _parameters(row: DetectorRow | DescriptorRow) -> Iterator[tuple[str, str]]:
    group = GROUPS.get(row.factory)
    if group is None:
        return
    for name, value in row.parameters.items():
        theirs = OTHERWISE.get(name, name[0].upper() + name[1:])
        if theirs is not None:
            yield f"{group}/{theirs}", _value(value)


def _value(value: Value) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return str(CONSTANTS[value]) if isinstance(value, str) else repr(value)
