"""Features agree with those that torch finds."""

from __future__ import annotations

import subprocess
import sys
from typing import Any

import numpy as np
import pytest
from aerocues_learned.extractors import AlikedN16Rot, AlikedT16, LearnedExtractor, XFeat
from aerocues_learned.images import CELL
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from aerocues import Features

NAMES = ("xfeat", "aliked-t16", "aliked-n16rot")
KINDS = {"xfeat": XFeat, "aliked-t16": AlikedT16, "aliked-n16rot": AlikedN16Rot}


def made(name: str, **changed: Any) -> LearnedExtractor:
    kind = KINDS[name]
    return kind(**{**kind.parameters, **changed})


def torch_positions(name: str, golden: dict[str, NDArray[Any]], number: int) -> NDArray[Any]:
    """Positions of torch; XFeat's authors scale them from the corner of pixels, not the centre."""
    xy = golden[f"{name}_xy_{number}"]
    if name != "xfeat":
        return xy
    height, width = golden[f"image_{number}"].shape[:2]
    factor = np.array([width / (width // CELL * CELL), height / (height // CELL * CELL)])
    return np.asarray(xy + (factor - 1) / 2)


def closest(xy: NDArray[Any], features: Features) -> tuple[NDArray[Any], NDArray[Any]]:
    """For each point the distance of the nearest keypoint, and which one that is."""
    distance, nearest = cKDTree(features.keypoints.xy).query(xy)
    return np.asarray(distance), np.asarray(nearest)


@pytest.mark.parametrize("number", [1, 2])
@pytest.mark.parametrize("name", NAMES)
def test_keypoints_and_descriptors_are_those_of_torch(
    name: str, number: int, golden: dict[str, Any], features: dict[str, list[Features]]
) -> None:
    ours = features[name][number - 1]
    xy = torch_positions(name, golden, number)
    distance, nearest = closest(xy, ours)
    assert len(ours) == pytest.approx(len(xy), abs=3)
    assert (distance < 0.02).mean() > 0.98
    described = golden[f"{name}_descriptors_{number}"]
    found = distance[: len(described)] < 0.02
    own = ours.descriptors[nearest[: len(described)]]
    assert np.abs(own - described)[found].max() < 1e-3


@pytest.mark.parametrize("name", NAMES)
def test_the_strongest_come_first_and_descriptors_have_unit_length(
    name: str, features: dict[str, list[Features]]
) -> None:
    for each in features[name]:
        assert (np.diff(each.keypoints.response) <= 0).all()
        assert np.linalg.norm(each.descriptors, axis=1) == pytest.approx(1, abs=1e-4)
        assert each.descriptors.dtype == np.float32


@pytest.mark.parametrize("name", NAMES)
def test_a_limit_keeps_the_strongest(
    name: str, images: tuple[NDArray[np.uint8], ...], features: dict[str, list[Features]]
) -> None:
    few = made(name, count=50).extract(images[0])
    assert np.array_equal(few.keypoints.xy, features[name][0].keypoints.xy[:50])
    assert np.allclose(few.descriptors, features[name][0].descriptors[:50], atol=1e-5)


@pytest.mark.parametrize("name", NAMES)
def test_large_images_are_made_smaller_and_their_points_put_back(
    name: str, images: tuple[NDArray[np.uint8], ...], features: dict[str, list[Features]]
) -> None:
    twice = images[0].repeat(2, axis=0).repeat(2, axis=1)
    longest = max(images[0].shape)
    found = made(name, count=300, longest_side=longest).extract(twice)
    # The centre of the top-left pixel is at 0 in both: half a pixel of the large one apart.
    expected = 2 * features[name][0].keypoints.xy + 0.5
    distance, _ = closest(expected, found)
    assert np.median(distance) < 0.05


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("shape", [(8, 8), (20, 200), (33, 31)])
def test_small_images_give_few_features_or_none(name: str, shape: tuple[int, int]) -> None:
    image = np.random.default_rng(0).integers(0, 255, (*shape, 3), np.uint8)
    found = made(name).extract(image)
    assert len(found) < shape[0] * shape[1]
    assert np.isfinite(found.keypoints.xy).all()


@pytest.mark.parametrize("name", NAMES)
def test_an_image_without_anything_gives_no_features(name: str) -> None:
    assert len(made(name).extract(np.full((160, 192, 3), 90, np.uint8))) == 0


OUT_OF_MEMORY = """
import resource
import numpy as np
from aerocues_learned.extractors import AlikedT16

extractor = AlikedT16(**AlikedT16.parameters)
extractor.extract(np.zeros((64, 64, 3), np.uint8))
resource.setrlimit(resource.RLIMIT_DATA, (400 << 20, 400 << 20))
try:
    extractor.extract(np.zeros((1200, 1600, 3), np.uint8))
except MemoryError:
    print("told")
"""


def test_missing_memory_is_told_as_such() -> None:
    asked = [sys.executable, "-c", OUT_OF_MEMORY]
    run = subprocess.run(asked, capture_output=True, text=True, check=False)
    assert (run.stdout, run.stderr) == ("told\n", "")


@pytest.mark.parametrize("name", NAMES)
def test_the_same_image_gives_the_same_bits(
    name: str, images: tuple[NDArray[np.uint8], ...]
) -> None:
    first, second = (made(name).extract(images[1]) for _ in range(2))
    assert np.array_equal(first.keypoints.xy, second.keypoints.xy)
    assert np.array_equal(first.descriptors, second.descriptors)
