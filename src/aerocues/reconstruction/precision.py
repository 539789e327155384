"""How precise the keypoints of a scene are, by the matches that were verified."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aerocues.reconstruction.colmap import image_pair, open_database

Floats = NDArray[np.float64]

# Median of the absolute value of a normal variable, in sigmas.
MEDIAN_OF_NORMAL = 0.6745
# Median distance of two points whose four coordinates are each off by a sigma, in sigmas.
MEDIAN_OF_TRANSFER = 1.6651


def keypoint_error(database: Path) -> float | None:
    """The error of a coordinate of a keypoint, in pixels: a robust standard deviation.

    Of the distances of all verified matches from the geometry of their pair: the Sampson distance
    (Hartley and Zisserman, Multiple View Geometry, 2004, section 11.4.3) from an epipolar geometry,
    and where only a homography is known, the distance from where it puts the point. What known
    intrinsics do not tell, such as a distortion, counts as an error, too.

    Returns
    -------
    float or None
        None where nothing is verified.
    """
    opened = open_database(database)
    try:
        cameras = {camera.camera_id: camera for camera in opened.read_all_cameras()}
        images = {image.image_id: image for image in opened.read_all_images()}
        points = {
            number: np.asarray(opened.read_keypoints(number), np.float64)[:, :2]
            for number in images
        }
        pair_ids, geometries = opened.read_two_view_geometries()
    finally:
        opened.close()
    errors = [np.empty(0)]
    for pair_id, geometry in zip(pair_ids, geometries, strict=True):
        matches = np.asarray(geometry.inlier_matches, np.int64).reshape(-1, 2)
        if len(matches):
            pair = image_pair(pair_id)
            both = [points[number][matches[:, side]] for side, number in enumerate(pair)]
            intrinsics = [
                np.asarray(cameras[images[number].camera_id].calibration_matrix())
                for number in pair
            ]
            errors.append(_errors(geometry, both[0], both[1], intrinsics))
    joined = np.concatenate(errors)
    return float(np.median(joined)) if len(joined) else None


def _errors(geometry: Any, first: Floats, second: Floats, intrinsics: list[Floats]) -> Floats:
    """Distances of matches from the geometry of their pair, each as the sigma it is the median of.

    Those of pairs whose geometry is not known are left out.
    """
    kind = str(getattr(geometry.config, "name", geometry.config)).upper()
    if kind in ("CALIBRATED", "2"):
        inverse = [np.linalg.inv(matrix) for matrix in intrinsics]
        return _sampson(inverse[1].T @ geometry.E @ inverse[0], first, second) / MEDIAN_OF_NORMAL
    if kind in ("UNCALIBRATED", "3"):
        return _sampson(geometry.F, first, second) / MEDIAN_OF_NORMAL
    if kind in ("PLANAR", "PANORAMIC", "PLANAR_OR_PANORAMIC", "4", "5", "6"):
        mapped = _homogeneous(first) @ np.asarray(geometry.H).T
        apart = np.linalg.norm(mapped[:, :2] / mapped[:, 2:] - second, axis=1)
        return np.asarray(apart / MEDIAN_OF_TRANSFER)
    return np.empty(0)


def _homogeneous(points: Floats) -> Floats:
    return np.column_stack([points, np.ones(len(points))])


def _sampson(matrix: Any, first: Floats, second: Floats) -> Floats:
    """First-order distance of matches from an epipolar geometry, in pixels."""
    one, other = _homogeneous(first), _homogeneous(second)
    forth, back = one @ np.asarray(matrix).T, other @ np.asarray(matrix)
    slope = forth[:, 0] ** 2 + forth[:, 1] ** 2 + back[:, 0] ** 2 + back[:, 1] ** 2
    return np.asarray(np.abs((other * forth).sum(axis=1)) / np.sqrt(slope))
