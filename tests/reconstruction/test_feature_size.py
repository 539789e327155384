"""Features of smaller images at the size of the images."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import aerocues
from aerocues.datasets.dataset import Dataset, Image, Pixels
from aerocues.datasets.decoded import DecodedSource
from aerocues.methods.arrays import Keypoints
from aerocues.reconstruction.feature_size import at_full_size, features_scale, smaller
from tests.methods.pictures import textured
from tests.reconstruction.scenes import Options

IMAGE = Image("view", DecodedSource(Pixels(textured(320, 240))))


def test_a_point_of_a_smaller_image_lies_where_it_lay() -> None:
    """Of half the width, pixel 10 covers pixels 20 and 21: its centre is 20.5."""
    assert smaller(IMAGE, 160).source.read().bgr.shape == (120, 160, 3)
    found = Keypoints.from_xy(np.array([[10.0, 4.0]], np.float32))
    moved = at_full_size(found, IMAGE, 160)
    np.testing.assert_allclose(moved.xy, [[20.5, 8.5]])
    np.testing.assert_allclose(moved.size, 2 * found.size)
    assert features_scale(IMAGE, 160) == 2.0


def test_images_that_are_small_enough_stay_as_they_are() -> None:
    found = Keypoints.from_xy(np.array([[10.0, 4.0]], np.float32))
    for width in (None, 320, 1000):
        assert at_full_size(found, IMAGE, width).xy.tolist() == [[10.0, 4.0]]
        assert features_scale(IMAGE, width) == 1.0


@pytest.mark.slow
def test_features_of_half_the_width_make_a_model(
    landscape: Dataset, empty: Path, quick: Options
) -> None:
    models = aerocues.reconstruct(
        landscape, "SIFT-SIFT-L2-EXACT", empty, features_width=240, workers=1, **quick
    )
    [row] = models.table().to_dicts()
    assert (row["status"], row["registered_images"], row["features_width"]) == ("ok", 6, 240)
    assert row["reprojection_error"] < 0.5
