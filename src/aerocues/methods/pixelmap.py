"""The pair matcher PIXELMAP: dense correspondence by grids of local affine maps."""

from __future__ import annotations

from dataclasses import dataclass
from importlib.util import find_spec
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aerocues.methods.arrays import Float32Array

WIDTHS = {"low": 400, "medium": 800, "high": 1600}
"""Pixels to which each quality brings images; done here, where it is exact."""
SMALLEST = 32
"""Pixels that PIXELMAP needs on each side."""
SHIFT = 0.5
"""Its positions are so many pixels too small in both directions, as turned images show."""


def why_not_pixelmap() -> str | None:
    """Why PIXELMAP cannot be used here, or None; it is not loaded for it."""
    if find_spec("pixelmap") is None:
        return "pixelmap-python is not installed; install it: pip install 'aerocues[pixelmap]'"
    return None


class PixelMap:
    """Looks up the places of a regular grid of each image in the other one.

    The places are the same in each pair of an image, so that tracks over several pairs form.

    Parameters
    ----------
    quality : {"low", "medium", "high"}
        Images of a width of 400, 800 or 1600 pixels are compared.
    spacing : int
        Pixels between places.
    seed : int
    """

    def __init__(self, quality: str, spacing: int, seed: int) -> None:
        self._quality = quality
        self._spacing = spacing
        self._seed = seed

    def match_pair(
        self, image_1: NDArray[np.uint8], image_2: NDArray[np.uint8]
    ) -> tuple[Float32Array, Float32Array, Float32Array]:
        """Positions in both images, and minus the pixels by which the way there and back is off."""
        import pixelmap

        images = (image_1, image_2)
        sizes = [np.array(image.shape[1::-1]) for image in images]
        whole = np.max(sizes, axis=0)  # images of one size are asked for
        width = WIDTHS[self._quality]
        small = np.array([width, max(round(whole[1] * width / whole[0]), SMALLEST)])
        native = pixelmap.correspond(
            *(_resized(image, whole, small) for image in images),
            quality=self._quality,
            seed=self._seed,
        )
        found = _Found(native, small / whole)
        there = self._looked_up(found, sizes[0], sizes[1], backward=False)
        back = self._looked_up(found, sizes[1], sizes[0], backward=True)
        first = np.concatenate([there[0], back[1]])
        second = np.concatenate([there[1], back[0]])
        return first, second, np.concatenate([there[2], back[2]])

    def _looked_up(
        self, found: _Found, own: NDArray[np.int64], other: NDArray[np.int64], *, backward: bool
    ) -> tuple[Float32Array, Float32Array, Float32Array]:
        """Places of an image, where they are in the other one, and how sure that is."""
        middle = self._spacing // 2
        y, x = np.mgrid[middle : own[1] : self._spacing, middle : own[0] : self._spacing]
        places = np.stack([x.ravel(), y.ravel()], axis=1).astype(np.float32)
        seen = found.lookup(places, backward=backward)
        inside = ((seen >= 0) & (seen < other)).all(axis=1)
        places, seen = places[inside], seen[inside]
        again = found.lookup(seen, backward=not backward)
        return places, seen, -np.linalg.norm(again - places, axis=1).astype(np.float32)


@dataclass(frozen=True, eq=False)
class _Found:
    """What PIXELMAP found in images of another size: so many times as large in x and y."""

    native: Any
    scale: NDArray[np.float64]

    def lookup(self, places: Float32Array, *, backward: bool) -> Float32Array:
        """Where (N, 2) places are in the other image; not a number where that is not known."""
        small = ((places + 0.5) * self.scale - 0.5 - SHIFT).astype(np.float32)
        found = self.native.lookup(small[:, 0].copy(), small[:, 1].copy(), backward=backward)
        seen = (np.stack(found, axis=1) + SHIFT + 0.5) / self.scale - 0.5
        return np.asarray(seen, np.float32)


def _resized(
    image: NDArray[np.uint8], whole: NDArray[np.int64], small: NDArray[np.int64]
) -> NDArray[np.uint8]:
    """The image in red, green, blue, with black below and to the right up to a size, resized."""
    import cv2

    padded = np.zeros((whole[1], whole[0], 3), np.uint8)
    padded[: image.shape[0], : image.shape[1]] = image[:, :, ::-1]
    how = cv2.INTER_AREA if small[0] < whole[0] else cv2.INTER_LINEAR
    return np.asarray(cv2.resize(padded, small.tolist(), interpolation=how), np.uint8)
