"""Reconstructions that fail say why, and cost only themselves."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

import aerocues
from aerocues.datasets.dataset import Dataset, Image
from aerocues.datasets.decoding import FileSource
from aerocues.errors import AerocuesError, ReconstructionError
from aerocues.results.metrics import Row
from tests.methods.distribution import write_distribution
from tests.methods.pictures import textured
from tests.reconstruction.scenes import GRID, Options, scene_of, write_scene

pytestmark = pytest.mark.slow

ORB = "ORB-ORB-HAM-BF"
Picture = Callable[[int], np.ndarray]


def noise(number: int) -> np.ndarray:
    return np.random.default_rng(number).integers(0, 256, (240, 320, 3), dtype=np.uint8)


def gray(number: int) -> np.ndarray:
    return np.full((240, 320, 3), 128, np.uint8)


def always_the_same(number: int) -> np.ndarray:
    return textured(320, 240, seed=0)


def scene(folder: Path, picture: Picture, count: int = 4) -> Dataset:
    folder.mkdir(parents=True)
    images = []
    for number in range(count):
        path = folder / f"{number}.png"
        cv2.imwrite(str(path), picture(number))
        images.append(Image(path.name, FileSource(path)))
    return scene_of(images)


def only_row(dataset: Dataset, output: Path, options: Options, name: str = ORB) -> Row:
    [row] = aerocues.reconstruct(dataset, name, output, **options).table().to_dicts()
    return row


@pytest.mark.parametrize(
    ("picture", "status", "message"),
    [
        (gray, "no_features", "4 of 4 images"),
        (noise, "no_verified_pair", "6 pairs"),
    ],
)
def test_images_without_anything_in_common(
    picture: Picture, status: str, message: str, tmp_path: Path, quick: Options
) -> None:
    options = {**quick, "focal_length": 300.0}
    row = only_row(scene(tmp_path / "images", picture), tmp_path / "models", options)
    assert row["status"] == status
    assert message in row["message"]
    assert row["registered_images"] is None


def test_identical_images_have_no_angle_between_them(tmp_path: Path, quick: Options) -> None:
    options = {**quick, "focal_length": 300.0}
    row = only_row(scene(tmp_path / "images", always_the_same), tmp_path / "models", options)
    assert row["status"] == "no_initial_pair"
    assert "0.0 degrees" in row["message"]
    assert "25 inliers and 4 degrees" in row["message"]


def test_two_groups_that_do_not_meet_are_named(tmp_path: Path, quick: Options) -> None:
    one = write_scene(tmp_path / "one", [(0, 0), (9, 0), (0, 9), (9, 9)], truth=False)
    two = write_scene(tmp_path / "two", [(0, 0), (9, 0), (0, 9)], truth=False, seed=7)
    images = [replace(image, name=f"one/{image.name}") for image in one.images]
    images += [replace(image, name=f"two/{image.name}") for image in two.images]
    options = {**quick, "focal_length": 420.0}
    row = only_row(scene_of(images), tmp_path / "models", options, "SIFT-SIFT-L2-FLANN")
    assert row["status"] == "incomplete"
    assert (row["registered_images"], row["components"]) == (4, 2)
    assert "4 of 7 images" in row["message"]
    assert row["message"].endswith(
        "4 images (one/view_0.png, one/view_1.png, one/view_2.png, ...), 3 images "
        "(two/view_0.png, two/view_1.png, two/view_2.png)"
    )


@pytest.fixture
def faulty(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Descriptors that go wrong, as if installed."""
    offered = {
        "NANS": "tests.reconstruction.faulty:NanDescriptor",
        "DYING": "tests.reconstruction.faulty:DyingDescriptor",
        "GREEDY": "tests.reconstruction.faulty:GreedyDescriptor",
    }
    write_distribution(tmp_path / "site", "aerocues-faults", {"descriptors": offered}, {})
    monkeypatch.syspath_prepend(tmp_path / "site")


@pytest.mark.usefixtures("faulty")
def test_methods_that_go_wrong_are_named_and_the_rest_goes_on(
    landscape: Dataset, quick: Options, empty: Path
) -> None:
    four = scene_of(landscape.images[:4])
    names = "ORB-NANS-HAM-BF,ORB-DYING-HAM-BF,ORB-GREEDY-HAM-BF,ORB-ORB-HAM-BF"
    table = aerocues.reconstruct(four, names, empty, **quick).table()
    rows = {row["descriptor"]: row for row in table.to_dicts()}
    assert rows["ORB"]["status"] == "ok"
    assert rows["NANS"]["status"] == "error"
    assert rows["NANS"]["message"].startswith("NANS describing view_0.png ")
    assert rows["DYING"]["status"] == "crashed"
    assert rows["GREEDY"]["status"] == "out_of_memory"
    assert "GREEDY describing ORB keypoints of view_0.png" in rows["GREEDY"]["message"]
    assert "SIGSEGV" in rows["DYING"]["message"]
    assert "describe ORB-DYING on view_0.png" in rows["DYING"]["message"]


def test_a_stage_that_takes_too_long_is_ended(
    landscape: Dataset, quick: Options, empty: Path, watched_closely: None
) -> None:
    options = {**quick, "timeout": 0.02}
    row = only_row(landscape, empty, options, "SIFT-SIFT-L2-FLANN")
    assert row["status"] == "timeout"
    # A busy machine may give it no core in so short a time.
    told = ("used more than 0.02 CPU seconds", "sat idle for 0.02 seconds")
    assert row["message"].startswith("detect SIFT on view_0.png ")
    assert row["message"].endswith(told)
    same = only_row(landscape, empty, options, "SIFT-SIFT-L2-FLANN")
    assert same["reconstructed_at"] == row["reconstructed_at"]
    # With more time it is tried again by itself.
    assert only_row(landscape, empty, quick, "SIFT-SIFT-L2-FLANN")["status"] == "ok"


def test_gray_images_leave_out_what_needs_colour(tmp_path: Path, quick: Options) -> None:
    folder = tmp_path / "images"
    folder.mkdir()
    images = []
    for number in range(2):
        path = folder / f"{number}.png"
        cv2.imwrite(str(path), noise(number)[:, :, 0])
        images.append(Image(path.name, FileSource(path)))
    options = {**quick, "focal_length": 300.0}
    with pytest.raises(ReconstructionError, match="LUCID"):
        only_row(scene_of(images), tmp_path / "models", options, "ORB-LUCID-HAM-BF")
    row = only_row(
        scene_of(images), tmp_path / "models", options, "ORB-LUCID-HAM-BF,ORB-ORB-HAM-BF"
    )
    assert row["descriptor"] == "ORB"


def test_an_image_that_cannot_be_read_is_left_out(
    tmp_path: Path, empty: Path, quick: Options
) -> None:
    dataset = write_scene(tmp_path / "images", GRID[:5])
    [path] = (tmp_path / "images").rglob(dataset.images[4].name)
    path.write_bytes(path.read_bytes()[:5000])
    row = only_row(dataset, empty, quick, "SIFT-SIFT-L2-FLANN")
    assert (row["status"], row["images"], row["registered_images"]) == ("ok", 4, 4)
    assert row["message"].endswith(f"1 image cannot be read: {path.name}")
    for image in (tmp_path / "images").rglob("*.png"):
        image.write_bytes(b"")
    with pytest.raises(AerocuesError, match=r"view_\d\.png"):
        only_row(dataset, tmp_path / "more", quick)
