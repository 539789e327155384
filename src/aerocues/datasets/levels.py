"""The range of values of 16-bit and floating-point images that becomes 0 to 255.

One for all images of a scene: an image that is scaled by its own extremes matches no other as soon
as it alone shows a reflection of the sun or a hot spot.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

PERCENTILES = (0.5, 99.5)
MARGIN = 0.25
"""Of the range between the percentiles: what lies farther off is a highlight or a fault."""
SAMPLED_IMAGES = 16
SAMPLED_VALUES = 100_000


@dataclass(frozen=True)
class Levels:
    """The values that become 0 and 255; all beyond are clipped."""

    low: float
    high: float

    def __str__(self) -> str:
        return f"{self.low:.6g} to {self.high:.6g}"

    def scaled(self, values: NDArray[Any]) -> NDArray[np.uint8]:
        """Values as 8 bits; those that are not finite become 0."""
        shifted = (values.astype(np.float32) - np.float32(self.low)) * np.float32(
            255.0 / max(self.high - self.low, 1e-12)
        )
        clipped = np.rint(np.clip(np.nan_to_num(shifted, nan=0.0), 0, 255))
        scaled: NDArray[np.uint8] = clipped.astype(np.uint8)
        return scaled


def robust_levels(values: NDArray[Any]) -> Levels:
    """The range of values without highlights and faults.

    Parameters
    ----------
    values : array
        Finite; any shape.

    Returns
    -------
    Levels
        The extremes, where these are near the percentiles.
    """
    if not values.size:
        return Levels(0.0, 1.0)
    low, high = (float(each) for each in np.percentile(values, PERCENTILES))
    room = MARGIN * (high - low)
    return Levels(max(low - room, float(values.min())), min(high + room, float(values.max())))


def sampled(values: NDArray[Any]) -> NDArray[Any]:
    """A part of the values of an image, evenly spread."""
    flat = values.reshape(-1)
    return flat[:: max(flat.size // SAMPLED_VALUES, 1)]


def spread_over(items: Sequence[Any], most: int = SAMPLED_IMAGES) -> list[Any]:
    """Some of the images of a scene, evenly spread."""
    chosen = np.unique(np.linspace(0, len(items) - 1, min(most, len(items))).round().astype(int))
    return [items[index] for index in chosen]


def common_levels(samples: Iterable[NDArray[Any]]) -> Levels | None:
    """The range of values of several images; None without any value."""
    found = [each.astype(np.float64) for each in samples if each.size]
    return robust_levels(np.concatenate(found)) if found else None
