"""Explains why there is no model, or why it is not a success."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from aerocues.reconstruction.alignment import root_mean_square
from aerocues.reconstruction.colmap import open_database
from aerocues.reconstruction.match_graph import LISTED, parts_of, told_parts
from aerocues.reconstruction.matched_scene import Names
from aerocues.reconstruction.protocol import Requirements
from aerocues.reconstruction.truth import GPS_IN_PLAN, Located

# COLMAP's requirements for the initial pair, after relaxing them twice.
INITIAL_INLIERS = 25
INITIAL_ANGLE = 4.0


@dataclass(frozen=True)
class Outcome:
    """A status of `reconstruction_schema.RECONSTRUCTION_STATUSES`, with the reason."""

    status: str
    message: str | None = None


def without_features(counts: Mapping[str, int]) -> Outcome | None:
    """The failure if too few images have keypoints."""
    empty = [name for name, count in counts.items() if not count]
    if len(counts) - len(empty) >= 2:
        return None
    return Outcome("no_features", f"{len(empty)} of {len(counts)} images have no keypoints")


def without_links(pairs: int, linked: int, verified: int, *, chance: bool) -> Outcome | None:
    """The failure if no pair is verified; `chance`: whether pairs had to beat chance."""
    if verified:
        return None
    asked = "matches that beat chance" if chance else "enough matches"
    if linked:
        return Outcome("no_verified_pair", f"COLMAP verified none of {linked} pairs with {asked}")
    return Outcome("no_verified_pair", f"none of {pairs} pairs has {asked}")


def without_model(
    database: Path, inliers: Mapping[Names, int], numbers: Mapping[str, int]
) -> Outcome:
    """Why the mapper made no model."""
    angles = _angles(database, inliers, numbers)
    most = max(inliers, key=lambda pair: (inliers[pair], pair))
    enough = [pair for pair in inliers if inliers[pair] >= INITIAL_INLIERS]
    asks = f"COLMAP requires {INITIAL_INLIERS} inliers and {INITIAL_ANGLE:g} degrees"
    if not enough:
        told = f"the best pair ({_pair(most)}) has {inliers[most]} inliers"
        return Outcome("no_initial_pair", f"no initial pair: {told}; {asks}")
    widest = max(enough, key=lambda pair: (angles[pair], pair))
    told = (
        f"the pair with the most inliers ({_pair(most)}) has {inliers[most]} at {angles[most]:.1f} "
        f"degrees, the widest angle ({_pair(widest)}) is {angles[widest]:.1f} with "
        f"{inliers[widest]}"
    )
    if angles[widest] < INITIAL_ANGLE:
        return Outcome("no_initial_pair", f"no initial pair: {told}; {asks}")
    return Outcome("no_model", f"no pair could be extended to a model: {told}")


def _pair(names: Names) -> str:
    return " and ".join(names)


def _angles(
    database: Path, inliers: Mapping[Names, int], numbers: Mapping[str, int]
) -> dict[Names, float]:
    """Median triangulation angle of each verified pair in degrees; 0 without a pose."""
    import pycolmap

    opened = open_database(database)
    try:
        cameras = {camera.camera_id: camera for camera in opened.read_all_cameras()}
        images = {image.image_id: image for image in opened.read_all_images()}
        found = {}
        for names in inliers:
            first, second = (images[numbers[name]] for name in names)
            geometry = opened.read_two_view_geometry(first.image_id, second.image_id)
            points = [_xy(opened.read_keypoints(image.image_id)) for image in (first, second)]
            has_pose = pycolmap.estimate_two_view_geometry_pose(
                cameras[first.camera_id], points[0], cameras[second.camera_id], points[1], geometry
            )
            found[names] = float(np.degrees(geometry.tri_angle)) if has_pose else 0.0
    finally:
        opened.close()
    return found


def _xy(keypoints: Any) -> Any:
    return np.asarray(keypoints, np.float64)[:, :2]


def told_place(located: Located) -> str:
    """``1 of 18 cameras is more than 5.0 m from its true position (gps): a (23.1 m)``."""
    far, errors = located.far, located.errors
    listed = ", ".join(f"{name} ({errors[name]:.1f} m)" for name in far[:LISTED])
    more = ", ..." if len(far) > LISTED else ""
    are, their = ("is", "its") if len(far) == 1 else ("are", "their")
    return (
        f"{len(far)} of {len(errors)} cameras {are} more than {located.tolerance[0]:.1f} m from "
        f"{their} true position{'s' * (len(far) > 1)} ({located.truth.source}): {listed}{more}"
    )


def _mostly_far(located: Located, requirements: Requirements) -> bool:
    """Whether too many of the cameras whose position is known are elsewhere."""
    allowed = (1 - requirements.registered_share) * len(located.differences)
    return bool(located.truth.left_out) and len(located.far) > allowed


def _heights_left_out(located: Located) -> str:
    heights = root_mean_square(np.array([each[2] for each in located.differences.values()]))
    return (
        f"GPS heights are not used: their error is {heights:.1f} m (root mean square), although "
        "horizontal positions agree; either they are wrong, or the model is bent vertically"
    )


def judged(
    images: Sequence[str],
    in_model: Sequence[str],
    inliers: Mapping[Names, int],
    located: Located | None,
    requirements: Requirements,
) -> Outcome:
    """Judge whether a model is complete and correctly placed.

    Parameters
    ----------
    images, in_model : sequence of str
        All images of the scene, and those of the model.
    inliers : mapping of pairs to int
        Inliers of the verified pairs.
    located : Located, optional
        Position errors, if positions are known.
    requirements : Requirements
    """
    least = requirements.registered_share * len(images)
    if len(in_model) < least:
        return Outcome("incomplete", _incomplete(images, in_model, inliers))
    told = []
    if located is not None and located.far:
        if len(in_model) - len(located.far) < least or _mostly_far(located, requirements):
            what = "the model is bent or wrongly joined"
            return Outcome("misplaced", f"{told_place(located)}; {what}")
        told.append(told_place(located))
    if located is not None and located.truth.source == GPS_IN_PLAN:
        told.append(_heights_left_out(located))
    if len(in_model) < len(images):
        told.append(_incomplete(images, in_model, inliers))
    return Outcome("ok", "; ".join(told) or None)


def _incomplete(
    images: Sequence[str], in_model: Sequence[str], inliers: Mapping[Names, int]
) -> str:
    held = f"the model has {len(in_model)} of {len(images)} images"
    parts = parts_of(images, inliers)
    if len(parts) > 1:
        return f"{held}; the graph of verified pairs consists of {told_parts(parts)}"
    missing = [name for name in images if name not in set(in_model)]
    best = []
    for name in missing[:LISTED]:
        links = [count for pair, count in inliers.items() if name in pair]
        best.append(f"{name} ({len(links)} pairs, at most {max(links)} inliers)")
    more = ", ..." if len(missing) > LISTED else ""
    whole = f"{held}, although the graph of verified pairs is connected"
    return f"{whole}; missing: {', '.join(best)}{more}"
