"""The input database of COLMAP, which its own program can open, too."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from aerocues.methods.arrays import Keypoints
from aerocues.reconstruction.colmap import image_pair, open_database
from aerocues.reconstruction.images import HALF_PIXEL
from aerocues.reconstruction.matched_scene import MatchedScene, Names
from aerocues.reconstruction.scene import Scene


def write_database(file: Path, scene: Scene, matched: MatchedScene) -> dict[str, int]:
    """Create the database: cameras, images, keypoints and matches.

    An existing file is replaced, even if it is damaged.

    Returns
    -------
    dict of str to int
        COLMAP's IDs of the images.
    """
    new_database(file, scene)
    database = open_database(file)
    try:
        numbers = {str(image.name): int(image.image_id) for image in database.read_all_images()}
        for name, keypoints in matched.keypoints.items():
            database.write_keypoints(numbers[name], _rows(keypoints))
        for (first, second), matches in matched.pairs.items():
            indices = matches.indices.astype(np.uint32)
            database.write_matches(numbers[first], numbers[second], indices)
    finally:
        database.close()
    return numbers


def new_database(file: Path, scene: Scene) -> None:
    """Make the database anew with cameras and images alone."""
    import pycolmap

    for old in file.parent.glob(f"{file.name}*"):  # also what SQLite keeps beside it
        old.unlink()
    open_database(file).close()
    for group in scene.cameras:
        options = pycolmap.ImageReaderOptions()
        options.camera_model = group.model
        options.camera_params = ", ".join(f"{value:.17g}" for value in group.parameters)
        pycolmap.import_images(
            file, scene.images, pycolmap.CameraMode.SINGLE, list(group.names), options
        )


def keypoint_rows(keypoints: Keypoints) -> NDArray[np.float32]:
    """Position, scale and orientation in radians of keypoints, (N, 4).

    The centre of the top-left pixel is (0, 0), unlike in COLMAP.
    """
    scale, orientation = keypoints.size / 2, np.radians(np.maximum(keypoints.angle, 0))
    return np.column_stack([keypoints.xy, scale, orientation]).astype(np.float32)


def _rows(keypoints: Keypoints) -> NDArray[np.float32]:
    """The same for COLMAP, where that centre is (0.5, 0.5)."""
    rows = keypoint_rows(keypoints)
    rows[:, :2] += np.float32(HALF_PIXEL)
    return rows


def verified_inliers(file: Path, numbers: Mapping[str, int]) -> dict[Names, int]:
    """Number of inliers of each verified pair of images."""
    return {names: len(indices) for names, indices in verified_matches(file, numbers).items()}


def verified_matches(file: Path, numbers: Mapping[str, int]) -> dict[Names, NDArray[np.int64]]:
    """Matches of each verified pair that agree with its geometry, (K, 2) indices of keypoints."""
    names = {number: name for name, number in numbers.items()}
    database = open_database(file)
    try:
        pair_ids, geometries = database.read_two_view_geometries()
    finally:
        database.close()
    found = {}
    for pair_id, geometry in zip(pair_ids, geometries, strict=True):
        first, second = image_pair(pair_id)
        if len(geometry.inlier_matches):
            matches = np.asarray(geometry.inlier_matches, np.int64)
            found[names[first], names[second]] = matches
    return found
