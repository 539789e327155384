"""How many images a final can build in time."""

from __future__ import annotations

import polars as pl
import pytest

from aerocues.modelling.affordable import SIZES, TIMED, affordable_images, slowness_of


def affordable(
    seconds: float, slowness: float = 1.0, images: int = 18, keypoints: int = 8000
) -> int:
    return affordable_images(images, seconds, slowness, megapixels=0.8, max_keypoints=keypoints)


def test_images_that_fit() -> None:
    """0.8 megapixels: 1.9 s an image, 0.13 s a pair and 4 s.

    18 images take 34.2 + 19.89 + 4 s, 12 of them 22.8 + 8.58 + 4.
    """
    assert affordable(58.1) == SIZES[0]  # all that there are
    assert affordable(58.1, images=100) == 18
    assert affordable(58.0) == 12
    assert affordable(35.3) == SIZES[-1]
    assert affordable(116.2, slowness=2.0, images=100) == 18
    assert affordable(58.1, images=100, keypoints=0) == 18


def test_fewer_keypoints_are_matched_sooner() -> None:
    """A quarter of them: 34.2 + 4.97 + 4 s."""
    assert affordable(43.2, images=100, keypoints=2000) == 18


def test_a_slow_machine_still_builds_a_block() -> None:
    assert affordable(20.0, slowness=8.0) == SIZES[-1] == 8


def test_slowness_is_wall_over_cpu_seconds() -> None:
    """Two rows; 3 + 1 + 2 wall seconds against 1 + 1 + 1 in the one, the other failed."""
    wall = dict(zip(TIMED, ([3.0, None], [1.0, None], [2.0, None]), strict=True))
    rows = pl.DataFrame({**wall, **{f"{name}_cpu": [1.0, None] for name in TIMED}})
    assert slowness_of(rows) == pytest.approx(2.0)
    assert slowness_of(rows.tail(1)) == 1.0
    assert slowness_of(rows.with_columns(pl.lit(9.0).alias("verify_seconds_cpu"))) == 1.0
