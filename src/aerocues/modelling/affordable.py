"""How many images of a flight can be built in the time of a final, at the pace of a machine."""

from __future__ import annotations

from typing import TYPE_CHECKING

from aerocues.pipeline.block import MOST_IMAGES

if TYPE_CHECKING:
    import polars as pl

SIZES = (MOST_IMAGES, 24, 18, 12, 8)
"""Of a block: few, so that a pace that is a little different does not ask for other models.

Models of fewer images tell too little of those of a flight.
"""
# CPU seconds of COLMAP's default and the leader together, measured on 18 images of 1000 x 750
# pixels with 8,000 keypoints: COLMAP's SIFT of an image, and mapping it twice; matching two images
# by COLMAP; starting the processes.
SECONDS_PER_MEGAPIXEL, SECONDS_PER_IMAGE = 1.5, 0.7
SECONDS_PER_PAIR, KEYPOINTS_OF_PAIR = 0.13, 8000
SECONDS_TO_START = 4.0
TIMED = ("detect_seconds_1", "detect_seconds_2", "verify_seconds")


def affordable_images(
    images: int, seconds: float, slowness: float, *, megapixels: float, max_keypoints: int
) -> int:
    """The largest of `SIZES` of which COLMAP's default and the leader are built in time.

    Parameters
    ----------
    images : int
        That there are.
    seconds : float
        Wall time.
    slowness : float
        Wall seconds of a CPU second; see `slowness_of`.
    megapixels : float
        Of an image.
    max_keypoints : int
        0: all.
    """
    matched = min(max_keypoints or KEYPOINTS_OF_PAIR, KEYPOINTS_OF_PAIR) / KEYPOINTS_OF_PAIR
    for size in SIZES:
        number = min(size, images)
        pairs = number * (number - 1) / 2
        needed = number * (SECONDS_PER_MEGAPIXEL * megapixels + SECONDS_PER_IMAGE)
        needed += pairs * SECONDS_PER_PAIR * matched + SECONDS_TO_START
        if needed * slowness <= seconds:
            return size
    return SIZES[-1]


def slowness_of(rows: pl.DataFrame) -> float:
    """Wall seconds that a CPU second took while rows were measured; 1 where nothing tells."""
    import polars as pl

    wall, cpu = (
        float(rows.select(pl.sum_horizontal(pl.sum(f"{name}{end}") for name in TIMED)).item() or 0)
        for end in ("", "_cpu")
    )
    return max(wall / cpu, 1.0) if cpu > 0 else 1.0
