"""Features of smaller images, brought back to the size of the images.

Features of half the width cost a quarter; refined at full width, their keypoints are as exact.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from aerocues.datasets.dataset import Image, ImageSource, Pixels
from aerocues.datasets.fitting import fitted_size, scale_matrix, shrink
from aerocues.methods.arrays import Keypoints
from aerocues.results.hashing import content_hash


@dataclass(frozen=True, eq=False)
class SmallerSource:
    """Another source, shrunk to a width in pixels."""

    source: ImageSource
    width: int

    def read(self) -> Pixels:
        return shrink(self.source.read(), self.width)

    def content_key(self) -> str:
        return content_hash([self.source.content_key(), self.width])

    def is_gray(self) -> bool:
        return self.source.is_gray()


def smaller(image: Image, width: int | None) -> Image:
    """The image at the width of features; itself where none is asked for."""
    return replace(image, source=SmallerSource(image.source, width)) if width else image


def features_scale(image: Image, width: int | None) -> float:
    """How many pixels of the image are one pixel of the features."""
    if not width:
        return 1.0
    full = image.source.read().bgr.shape[1]
    return float(full / min(full, width))


def at_full_size(keypoints: Keypoints, image: Image, width: int | None) -> Keypoints:
    """Keypoints of the smaller image in pixels of the image."""
    if not width:
        return keypoints
    height, full = image.source.read().bgr.shape[:2]
    before, after = fitted_size((full, height), width), (full, height)
    if before == after:
        return keypoints
    matrix = scale_matrix(before, after)
    xy = keypoints.xy @ matrix[:2, :2].T + matrix[:2, 2]
    size = keypoints.size * np.float32(matrix[0, 0])
    return replace(keypoints, xy=xy.astype(np.float32), size=size.astype(np.float32))
