"""A small landscape of textured planes, photographed with exact poses and depth."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.dataset import Dataset, Image, Pair, PinholeCamera, TrueView
from aerocues.datasets.decoding import FileSource

Array = NDArray[np.float64]
Options = dict[str, Any]
"""What `aerocues.reconstruct` is given."""
CAMERA = PinholeCamera(480, 360, 420.0, 420.0, 239.5, 179.5)
MATRIX = np.array([[420.0, 0, 239.5], [0, 420.0, 179.5], [0, 0, 1]])
ALTITUDE = 40.0
HALF_WIDTH = 45.0
PIXELS_PER_METRE = 16
GRID = [(x, y) for y in (-9.0, 0.0) for x in (-9.0, 0.0, 9.0)]


@dataclass(frozen=True)
class Plane:
    """A horizontal rectangle: its height, its borders (west, east, south, north), its texture."""

    height: float
    borders: tuple[float, float, float, float]
    texture: NDArray[np.uint8]


@dataclass(frozen=True)
class DepthFile:
    """Depth in a file of numpy."""

    path: Path

    def read(self) -> NDArray[np.float32]:
        found: NDArray[np.float32] = np.load(self.path)
        return found

    def content_key(self) -> str:
        return hashlib.sha256(self.path.read_bytes()).hexdigest()


def _texture(generator: np.random.Generator, width: int, height: int) -> NDArray[np.uint8]:
    picture = np.zeros((height, width, 3), np.float32)
    for size, weight in ((3, 0.5), (9, 0.9), (31, 0.8)):
        small = generator.uniform(0, 255, (height // size + 2, width // size + 2, 3))
        grown = cv2.resize(small.astype(np.float32), (width, height), interpolation=cv2.INTER_CUBIC)
        picture += weight * grown
    low, high = picture.min(), picture.max()
    stretched: NDArray[np.uint8] = ((picture - low) * (255 / (high - low))).astype(np.uint8)
    return stretched


def landscape(seed: int = 0, *, roofs: int = 14) -> list[Plane]:
    """Ground and roofs from the lowest to the highest."""
    generator = np.random.default_rng(seed)
    size = int(2 * HALF_WIDTH * PIXELS_PER_METRE)
    ground = (-HALF_WIDTH, HALF_WIDTH, -HALF_WIDTH, HALF_WIDTH)
    planes = [Plane(0.0, ground, _texture(generator, size, size))]
    for height in sorted(generator.uniform(2, 9, roofs)):
        x, y = generator.uniform(-22, 18, 2)
        width, depth = generator.uniform(4, 8, 2)
        texture = _texture(generator, int(width * PIXELS_PER_METRE), int(depth * PIXELS_PER_METRE))
        planes.append(Plane(float(height), (x, x + width, y, y + depth), texture))
    return planes


def pose(x: float, y: float, turn: float, tilt: float) -> tuple[Array, Array]:
    """Rotation from the world (east, north, up) to the camera, and its centre."""
    down = np.diag([1.0, -1.0, -1.0])
    about_axis, _ = cv2.Rodrigues(np.array([0, 0, np.radians(turn)]))
    about_right, _ = cv2.Rodrigues(np.array([np.radians(tilt), 0, 0]))
    rotation: Array = about_right @ about_axis @ down
    return rotation, np.array([x, y, ALTITUDE])


def photograph(
    planes: Sequence[Plane], rotation: Array, centre: Array
) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
    """The picture and its planar depth in metres."""
    size = (CAMERA.width, CAMERA.height)
    picture = np.zeros((CAMERA.height, CAMERA.width, 3), np.uint8)
    depth = np.full((CAMERA.height, CAMERA.width), np.inf, np.float32)
    columns, rows = np.meshgrid(np.arange(CAMERA.width), np.arange(CAMERA.height))
    pixels = np.stack([columns, rows, np.ones_like(columns)], -1).reshape(-1, 3)
    rays = (np.linalg.inv(MATRIX) @ pixels.T).T @ rotation
    for plane in planes:
        west, east, south, north = plane.borders
        height, width = plane.texture.shape[:2]
        step_x, step_y = (east - west) / width, (north - south) / height
        corner = np.array([west + step_x / 2, north - step_y / 2, plane.height])
        on_plane = np.column_stack([[step_x, 0, 0], [0, -step_y, 0], corner - centre])
        homography = MATRIX @ rotation @ on_plane
        seen = cv2.warpPerspective(plane.texture, homography, size, flags=cv2.INTER_AREA)
        along = ((plane.height - centre[2]) / rays[:, 2]).reshape(depth.shape)
        points = centre + along.reshape(-1, 1) * rays
        x, y = points[:, 0].reshape(depth.shape), points[:, 1].reshape(depth.shape)
        covered = (x >= west) & (x <= east) & (y >= south) & (y <= north) & (along > 0)
        picture[covered] = seen[covered]
        depth[covered] = along[covered]
    return picture, depth


def write_scene(
    folder: Path,
    places: Sequence[tuple[float, float]] = tuple(GRID),
    *,
    pairs: Sequence[tuple[str, str]] | None = None,
    truth: bool = True,
    seed: int = 0,
) -> Dataset:
    """Photographs of the landscape from places above it; all pairs unless some are given."""
    folder.mkdir(parents=True, exist_ok=True)
    generator = np.random.default_rng(seed + 1)
    planes = landscape(seed)
    images = []
    for number, (x, y) in enumerate(places):
        rotation, centre = pose(x, y, generator.uniform(-8, 8), generator.uniform(-4, 4))
        picture, depth = photograph(planes, rotation, centre)
        noisy = picture + generator.normal(0, 2, picture.shape)
        name = f"view_{number}.png"
        cv2.imwrite(str(folder / name), np.clip(noisy, 0, 255).astype(np.uint8))
        np.save(folder / f"depth_{number}.npy", depth)
        source = DepthFile(folder / f"depth_{number}.npy")
        view = TrueView(CAMERA, rotation, centre, source) if truth else None
        images.append(Image(name, FileSource(folder / name), truth=view))
    return scene_of(images, pairs)


def scene_of(images: Sequence[Image], pairs: Sequence[tuple[str, str]] | None = None) -> Dataset:
    """A dataset of images that are there."""
    chosen = list(combinations([image.name for image in images], 2)) if pairs is None else pairs
    return Dataset(
        "landscape",
        list(images),
        [Pair(index, first, second, "landscape") for index, (first, second) in enumerate(chosen)],
        "epipolar",
    )
