from __future__ import annotations

import pickle
from collections import Counter
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from aerocues.datasets import geometry
from aerocues.datasets.catalog import open_dataset
from aerocues.datasets.dataset import Dataset, Pixels
from aerocues.errors import DatasetError

BLOB_SIGMA = 3.0


def blobs(size: tuple[int, int]) -> tuple[NDArray[np.uint8], NDArray[np.float64]]:
    """A picture of smooth bright dots at known subpixel places, and the places (N, 2)."""
    width, height = size
    random = np.random.default_rng(5)
    grid = [(x, y) for x in range(30, width - 25, 40) for y in range(30, height - 25, 40)]
    places = np.array(grid, dtype=np.float64) + random.uniform(-3, 3, (len(grid), 2))
    y, x = np.mgrid[:height, :width]
    values = np.zeros((height, width))
    for px, py in places:
        values += 240 * np.exp(-((x - px) ** 2 + (y - py) ** 2) / (2 * BLOB_SIGMA**2))
    gray = np.rint(values).astype(np.uint8)
    return np.repeat(gray[..., None], 3, axis=2), places


def mapped(matrix: NDArray[np.float64], points: NDArray[np.float64]) -> NDArray[np.float64]:
    moved = np.column_stack([points, np.ones(len(points))]) @ matrix.T
    return np.asarray(moved[:, :2] / moved[:, 2:])


def centroids(gray: NDArray[np.uint8], near: NDArray[np.float64], reach: int) -> Any:
    """Centre of brightness around each of the places (N, 2)."""
    found = []
    for px, py in np.rint(near).astype(int):
        window = gray[py - reach : py + reach + 1, px - reach : px + reach + 1].astype(np.float64)
        y, x = np.mgrid[-reach : reach + 1, -reach : reach + 1]
        found.append(
            [px + (window * x).sum() / window.sum(), py + (window * y).sum() / window.sum()]
        )
    return np.array(found)


@pytest.mark.parametrize(
    ("kind", "value"),
    [("rotation", value) for value in (15, 30, 45, 75, 90, 135, 180)]
    + [("scale", value) for value in (0.5, 0.7, 0.9, 1.1, 1.3, 1.5)]
    + [("tilt", value) for value in (20, 40)],
)
def test_dots_land_where_the_homography_says(kind: str, value: float) -> None:
    size = (201, 160)
    bgr, places = blobs(size)
    matrix, new_size = geometry.placement(kind, value, size)
    warped = geometry.warp(Pixels(bgr), kind, value)
    assert warped.bgr.shape[:2] == new_size[::-1]
    expected = mapped(matrix, places)
    reach = round(4.5 * BLOB_SIGMA * (value if kind == "scale" else 1.0))
    error = np.linalg.norm(centroids(warped.bgr[..., 0], expected, reach) - expected, axis=1)
    # The centre of a blob seen at an angle is not the image of its centre.
    assert float(error.max()) < (0.1 if kind != "tilt" else 0.4)
    if kind == "tilt":
        shift = centroids(warped.bgr[..., 0], expected, reach) - expected
        assert float(np.abs(shift.mean(axis=0)).max()) < 0.1


def test_a_quarter_turn_moves_pixels_exactly() -> None:
    bgr, _ = blobs((71, 60))
    turned = geometry.warp(Pixels(bgr), "rotation", 90)
    assert turned.valid is None
    assert np.array_equal(turned.bgr, np.rot90(bgr))


@given(
    kind=st.sampled_from(["rotation", "scale", "tilt"]),
    width=st.integers(20, 3000),
    height=st.integers(20, 3000),
    part=st.floats(0, 1),
)
def test_the_canvas_holds_the_whole_picture(
    kind: str, width: int, height: int, part: float
) -> None:
    value = {"rotation": 360 * part, "scale": 0.3 + 2 * part, "tilt": 60 * part}[kind]
    matrix, (new_width, new_height) = geometry.placement(kind, value, (width, height))
    corners = np.array([[x, y] for x in (-0.5, width - 0.5) for y in (-0.5, height - 0.5)])
    moved = mapped(matrix, corners)
    low, high = moved.min(axis=0), moved.max(axis=0)
    assert float(low.min()) >= -0.5 - 1e-6
    assert np.all(high <= np.array([new_width, new_height]) - 0.5 + 1e-6)
    assert np.all(high - low > np.array([new_width, new_height]) - 2.001)
    assert np.linalg.det(matrix) > 0


def test_valid_is_what_the_picture_covers() -> None:
    white = np.full((100, 150, 3), 255, np.uint8)
    warped = geometry.warp(Pixels(white), "rotation", 30)
    assert warped.valid is not None
    assert (warped.bgr[warped.valid] == 255).all()
    assert warped.valid.sum() == pytest.approx(149 * 99, rel=0.01)
    mask = np.ones((100, 150), np.bool_)
    mask[:50] = False
    half = geometry.warp(Pixels(white, mask), "rotation", 180)
    assert half.valid is not None
    assert half.valid[:50].all()
    assert not half.valid[50:].any()


@pytest.fixture(scope="module")
def synthetic() -> Dataset:
    return open_dataset("synthetic")


def test_the_twenty_pairs(synthetic: Dataset) -> None:
    assert Counter(p.sequence for p in synthetic.pairs) == {
        "rotation": 6,
        "scale": 6,
        "intensity": 8,
    }
    assert [image.name for image in synthetic.images] == [
        "original",
        *(f"rotation_{angle:03d}" for angle in range(15, 91, 15)),
        *(f"scale_{factor}" for factor in ("0.50", "0.70", "0.90", "1.10", "1.30", "1.50")),
        *(f"intensity_add_{levels}" for levels in ("-30", "-10", "+10", "+30")),
        *(f"intensity_mul_{factor}" for factor in ("0.70", "0.90", "1.10", "1.30")),
    ]
    assert {p.image_1 for p in synthetic.pairs} == {"original"}
    assert (synthetic.name, synthetic.geometry) == ("synthetic", "homography")


def test_the_picture_in_the_package_is_the_same_as_ever(synthetic: Dataset) -> None:
    source = synthetic.image("original").source
    assert source.read().bgr.shape == (665, 1000, 3)
    # Rows that were measured before are found by this key.
    assert source.content_key()[:16] == "2b62138bb50af56e"


def test_photometric_changes_stay_in_place_and_clip(synthetic: Dataset) -> None:
    original = synthetic.image("original").read().bgr.astype(np.float64)
    for pair in synthetic.pairs[12:]:
        assert pair.homography is not None
        assert np.array_equal(pair.homography, np.eye(3))
    brighter = synthetic.image("intensity_add_+30").read().bgr
    assert np.array_equal(brighter, np.clip(original + 30, 0, 255))
    darker = synthetic.image("intensity_mul_0.70").read().bgr
    assert float(np.abs(darker - 0.7 * original).max()) <= 0.501


def test_everything_is_repeatable_and_pickles(synthetic: Dataset) -> None:
    copy = pickle.loads(pickle.dumps(synthetic))
    assert len(pickle.dumps(synthetic)) < 10_000
    for image in synthetic.images[::5]:
        twin = copy.image(image.name)
        assert np.array_equal(image.read().bgr, twin.read().bgr)
        assert image.source.content_key() == twin.source.content_key()
    assert len({image.source.content_key() for image in synthetic.images}) == 21


def test_extended_set_has_more_kinds() -> None:
    dataset = open_dataset("synthetic-extended", max_width=300)
    counts = Counter(p.sequence for p in dataset.pairs)
    assert counts["rotation"] == 12
    assert set(counts) == {
        "rotation", "scale", "intensity", "contrast", "noise", "blur", "jpeg", "tilt",
    }  # fmt: skip
    original = dataset.image("original").read().bgr.astype(np.float64)
    assert original.shape == (200, 300, 3)
    noise = dataset.image("noise_10").read().bgr - original
    assert 8 < float(noise.std()) < 10.5
    assert np.array_equal(noise + original, dataset.image("noise_10").read().bgr)
    errors = [
        float(np.abs(dataset.image(f"jpeg_{quality}").read().bgr - original).mean())
        for quality in ("50", "25", "10", "05")
    ]
    assert errors == sorted(errors)
    sharpness = [
        float(cv2.Laplacian(dataset.image(f"blur_{sigma}.0").read().bgr, cv2.CV_64F).var())
        for sigma in (1, 2, 3, 4)
    ]
    assert sharpness == sorted(sharpness, reverse=True)


def test_an_image_of_the_user(tmp_path: Path, picture: NDArray[np.uint8]) -> None:
    path = tmp_path / "mine.png"
    cv2.imwrite(str(path), np.tile(picture[..., :1], (1, 1, 1)))
    dataset = open_dataset(f"synthetic:{path}", max_width=40, equalize="histogram")
    assert dict(dataset.settings)["source"] == "mine.png"
    assert dataset.image("original").source.is_gray()
    assert dataset.image("scale_0.50").source.is_gray()
    assert dataset.image("scale_0.50").read().bgr.shape == (15, 20, 3)
    darker = dataset.image("intensity_mul_0.70").read().bgr
    original = dataset.image("original").read().bgr
    assert float(np.abs(darker.astype(int) - original).mean()) < 4  # equalised after the change
    for missing in (tmp_path / "gone.png", tmp_path):
        with pytest.raises(DatasetError):
            open_dataset(f"synthetic:{missing}")


def test_sift_matches_confirm_the_homographies() -> None:
    dataset = open_dataset("synthetic-extended", max_width=600)
    # By default OpenCV's SIFT puts every keypoint a quarter of a pixel to the lower right.
    sift: Any = cv2.SIFT_create(2000, enable_precise_upscale=True)
    first = sift.detectAndCompute(dataset.image("original").read().bgr, None)
    for name in ("rotation_030", "scale_0.70", "scale_1.30", "tilt_40"):
        pair = next(p for p in dataset.pairs if p.image_2 == name)
        assert pair.homography is not None
        second = sift.detectAndCompute(dataset.image(name).read().bgr, None)
        matches = cv2.BFMatcher(cv2.NORM_L2, crossCheck=True).match(first[1], second[1])
        start = np.array([first[0][m.queryIdx].pt for m in matches])
        end = np.array([second[0][m.trainIdx].pt for m in matches])
        offset = end - mapped(pair.homography, start)
        close = offset[np.linalg.norm(offset, axis=1) < 3]
        assert len(close) > 300
        assert float(np.abs(np.median(close, axis=0)).max()) < 0.06
