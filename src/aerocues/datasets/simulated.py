"""Simulated flights: images with exact poses, intrinsics and depth."""

from __future__ import annotations

import csv
import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.dataset import Dataset, Image, PinholeCamera, TrueView
from aerocues.datasets.fitting import fitted_size, scale_matrix
from aerocues.datasets.flight_angles import ENU_FROM_NED, camera_from_ned
from aerocues.datasets.folder import chosen_pairs, folder_images, scene_of, settings_of
from aerocues.datasets.options import Options
from aerocues.datasets.pairing import Consecutive
from aerocues.errors import DatasetError, ImageError
from aerocues.json_files import why_unreadable

_TRUTH = "truth"


@dataclass(frozen=True)
class DepthFile:
    """Depth in a ``.npy`` file, at the size of the images as read.

    Parameters
    ----------
    path : Path
    size : tuple of int
        Width and height of the images.
    """

    path: Path
    size: tuple[int, int]

    def read(self) -> NDArray[np.float32]:
        """Planar depth (H, W) float32 in metres; shrunk images take the nearest pixel.

        Depth is not averaged: the mean of a roof and the street next to it is not a surface.
        """
        try:
            stored = np.load(self.path, allow_pickle=False)
        except (OSError, ValueError) as error:
            raise ImageError(
                f"{self.path} is not a depth file ({error}); simulate the flight again"
            ) from error
        width, height = self.size
        if stored.shape == (height, width):
            return np.asarray(stored, np.float32)
        rows = _nearest(height, stored.shape[0])
        columns = _nearest(width, stored.shape[1])
        return np.asarray(stored[np.ix_(rows, columns)], np.float32)

    def content_key(self) -> str:
        digest = hashlib.sha256(repr(self.size).encode())
        try:
            digest.update(self.path.read_bytes())
        except OSError as error:
            raise ImageError(
                f"{self.path} cannot be read ({error.strerror}); simulate the flight again"
            ) from error
        return digest.hexdigest()


def _nearest(wanted: int, stored: int) -> NDArray[np.intp]:
    centres = (np.arange(wanted) + 0.5) * stored / wanted - 0.5
    return np.clip(np.floor(centres + 0.5), 0, stored - 1).astype(np.intp)


def open_simulated(folder: Path, options: Options) -> Dataset:
    """The images of a simulated flight, or of a folder inside one, with their ground truth.

    Raises
    ------
    DatasetError
        If there are fewer than two images, or the ground truth is missing.
    """
    root = _root(folder)
    truth = root / _TRUTH
    try:
        settings = json.loads((truth / "camera.json").read_text("utf-8"))
        camera = PinholeCamera(**settings["camera"])
        with (truth / "poses.csv").open(encoding="utf-8", newline="") as file:
            poses = {row["image"]: row for row in csv.DictReader(file)}
    except (OSError, ValueError) as error:
        raise DatasetError(
            f"{truth} cannot be read ({why_unreadable(error)}); simulate the flight again"
        ) from error
    except (KeyError, TypeError) as error:
        raise DatasetError(f"{truth} is incomplete; simulate the flight again") from error
    prefix = folder.resolve().relative_to(root.resolve())
    fitted = scaled_camera(camera, options.max_width)
    found, notes = folder_images(folder, options, tree=True)
    images = [
        _with_truth(image, (prefix / image.name).as_posix(), poses, fitted, truth)
        for image in found
    ]
    strategy, text = chosen_pairs(options)
    # The last image of one view and the first of the next are not consecutive.
    views = _by_folder(images) if isinstance(strategy, Consecutive) else [images]
    pairs = [pair for view in views for pair in strategy.pairs(view)]
    if not pairs:
        raise DatasetError(
            f'{folder} holds one image a view; use `pairs="exhaustive"` or `pairs="overlap:0.3"`'
        )
    settings = settings_of(images, options, pairs=text)
    return replace(scene_of(folder, images, pairs, settings), notes=notes)


def _by_folder(images: Sequence[Image]) -> list[list[Image]]:
    folders: dict[str, list[Image]] = {}
    for image in images:
        folders.setdefault(image.name.rpartition("/")[0], []).append(image)
    return list(folders.values())


def _root(folder: Path) -> Path:
    for parent in (folder.absolute(), *folder.absolute().parents):
        if (parent / _TRUTH / "poses.csv").is_file():
            return parent
    raise DatasetError(
        f"neither {folder} nor a folder above it has {_TRUTH}/poses.csv; "
        "make a flight with `aerocues.simulate`"
    )


def scaled_camera(camera: PinholeCamera, max_width: int | None) -> PinholeCamera:
    """The camera of images that were shrunk to `max_width`, including the half-pixel offset."""
    size = fitted_size((camera.width, camera.height), max_width)
    scale = scale_matrix((camera.width, camera.height), size)
    centre = scale @ [camera.centre_x, camera.centre_y, 1.0]
    focal_x, focal_y = camera.focal_x * scale[0, 0], camera.focal_y * scale[1, 1]
    return PinholeCamera(*size, float(focal_x), float(focal_y), float(centre[0]), float(centre[1]))


def _with_truth(
    image: Image, name: str, poses: Mapping[str, Any], camera: PinholeCamera, truth: Path
) -> Image:
    if name not in poses:
        raise DatasetError(f"{truth / 'poses.csv'} has no {name}; simulate the flight again")
    row = poses[name]
    centre = ENU_FROM_NED @ [float(row[axis]) for axis in ("north", "east", "down")]
    rotation = (
        camera_from_ned(*(float(row[angle]) for angle in ("pitch", "yaw", "roll"))) @ ENU_FROM_NED.T
    )
    depth = DepthFile(
        truth / "depth" / Path(name).with_suffix(".npy"), (camera.width, camera.height)
    )
    return replace(image, truth=TrueView(camera, rotation, centre, depth))
