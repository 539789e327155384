"""Options of ODM (OpenDroneMap), whose features are a fixed list."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from aerocues.exports.nearest import Kind, nearest
from aerocues.exports.recipe import Measured
from aerocues.methods.combination import Combination

FEATURES: Mapping[Kind, str] = {
    ("SIFT", "SIFT"): "sift",
    ("AKAZE", "KAZE"): "akaze",
    ("ORB", "ORB"): "orb",
}
"""Values of ``--feature-type``; ODM describes AKAZE keypoints by MSURF, which is that of KAZE."""
APPROXIMATE = "FLANN"


def odm_options(wanted: Combination, measured: Measured, ranked: Sequence[str] | None) -> str:
    """Options in one line; a comment tells how near they come, and what comes nearer."""
    found = nearest(wanted, FEATURES, ranked)
    one = found.combination
    lines = [f"# {one} in ODM; other parameters are ODM's own"]
    if found.reason:
        lines = [
            f"# ODM has no {wanted.detector} with {wanted.descriptor}.",
            f"# Nearest is {one}: {found.reason}.",
            f"# ODM uses {wanted} itself after: aerocues use {wanted} IMAGES --as odm -o DIR",
        ]
    matcher = "flann" if one.matcher == APPROXIMATE else "bruteforce"
    words = ["--feature-type", FEATURES[one.detector, one.descriptor], "--matcher-type", matcher]
    if measured.max_keypoints:
        words += ["--min-num-features", str(measured.max_keypoints)]
    lines.append(" ".join(words))
    return "".join(f"{line}\n" for line in lines)
