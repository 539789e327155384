"""Clouds: as files, in pictures, and the distances between them."""

from __future__ import annotations

import io
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from scipy.spatial.transform import Rotation

from aerocues.errors import StoreError
from aerocues.methods.combination import Combination
from aerocues.reconstruction.cloud_distance import cloud_distances
from aerocues.reconstruction.picture import picture_of
from aerocues.reconstruction.references import with_distances
from aerocues.results.clouds import Cloud, read_cloud
from aerocues.results.metrics import Row

CENTRES = np.array([[0, 0, 20], [10, 0, 20], [0, 10, 21], [10, 10, 22]], np.float32)


def cloud(points: np.ndarray, unit: str = "m", centres: np.ndarray = CENTRES) -> Cloud:
    count = len(points)
    return Cloud(
        points=np.asarray(points, np.float32),
        colours=np.full((count, 3), 90, np.uint8),
        errors=np.full(count, 0.5, np.float32),
        track_lengths=np.full(count, 3, np.int32),
        distances=np.full(count, np.nan, np.float32),
        centres=np.asarray(centres, np.float32),
        rotations=np.repeat(np.diag([1, -1, -1])[None], len(centres), 0).astype(np.float32),
        names=np.array([f"image {i}.jpg" for i in range(len(centres))]),
        positions=np.where(np.arange(len(centres))[:, None] % 2, np.nan, centres).astype("f4"),
        view=np.array([400, 480, 360], np.float32),
        unit=unit,
    )


def square(step: float = 1.0, height: float = 0.0) -> np.ndarray:
    x, y = np.meshgrid(np.arange(0, 10, step), np.arange(0, 10, step))
    return np.column_stack([x.ravel(), y.ravel(), np.full(x.size, height)])


def test_a_cloud_is_read_as_it_was_written() -> None:
    written = cloud(square())
    content = written.content()
    assert content == cloud(square()).content()
    read = read_cloud(content, "here")
    assert read.unit == "m"
    for name in ("points", "colours", "rotations", "names", "positions", "view"):
        np.testing.assert_array_equal(getattr(read, name), getattr(written, name))


@pytest.mark.parametrize("damage", [b"", b"nonsense", cloud(square()).content()[:400]])
def test_a_damaged_cloud_is_named(damage: bytes) -> None:
    with pytest.raises(StoreError, match=r"clouds/x\.npz"):
        read_cloud(damage, Path("clouds/x.npz"))


def test_shapes_that_do_not_fit_are_refused() -> None:
    with pytest.raises(ValueError, match=r"errors .*\(100,\).*\(3,\)"):
        replace(cloud(square()), errors=np.zeros(3, np.float32))


def test_distances_by_hand() -> None:
    found = cloud_distances(cloud(square(height=2.0)), cloud(square()))
    assert found is not None
    np.testing.assert_allclose(found.to_reference, 2.0)
    sparse = cloud_distances(cloud(square(step=5)), cloud(square()))
    assert sparse is not None
    figures = sparse.figures()
    # All sparse points are in the dense cloud; the farthest dense one, (9, 9), is 4 off twice.
    assert figures["cloud_distance_rms"] == pytest.approx(0, abs=1e-5)
    assert sparse.from_reference.max() == pytest.approx(32**0.5)
    assert figures["reference_distance_median"] == pytest.approx(np.median(sparse.from_reference))


def test_frames_do_not_matter() -> None:
    rotation = Rotation.random(random_state=2).as_matrix()
    moved = cloud(0.1 * square() @ rotation.T + 5, "unit", 0.1 * CENTRES @ rotation.T + 5)
    found = cloud_distances(moved, cloud(square()))
    assert found is not None
    np.testing.assert_allclose(found.to_reference, 0, atol=1e-4)


def test_too_few_shared_cameras_give_no_distance() -> None:
    other = cloud(square(), centres=CENTRES[:2])
    assert cloud_distances(other, cloud(square())) is None
    assert cloud_distances(cloud(np.empty((0, 3))), cloud(square())) is None


ORB, SIFT = Combination.parse("ORB-ORB-HAM-BF"), Combination.parse("SIFT-SIFT-L2-BF")


def rows(**statuses: str) -> dict[Combination, Row]:
    return {
        each: {
            "status": statuses[each.detector],
            "registered_images": 4,
            "points_3d": 100 if each == SIFT else 400,
            "row_key": each.detector,
        }
        for each in (ORB, SIFT)
    }


def test_the_reference_is_the_largest_model_that_succeeded() -> None:
    clouds = {ORB: cloud(square(height=1)), SIFT: cloud(square())}
    found, measured = with_distances(rows(ORB="misplaced", SIFT="ok"), clouds.get, None)
    assert [row["reference"] for row in found] == [str(SIFT)] * 2
    assert found[0]["cloud_distance_median"] == pytest.approx(1)
    assert found[1]["cloud_distance_rms"] == 0
    np.testing.assert_allclose(measured["ORB"].distances, 1)
    found, _ = with_distances(rows(ORB="ok", SIFT="ok"), clouds.get, None)
    assert found[1]["reference"] == str(ORB)
    found, _ = with_distances(rows(ORB="ok", SIFT="ok"), clouds.get, SIFT)
    assert found[0]["reference"] == str(SIFT)


def test_without_a_model_that_succeeded_there_is_no_distance() -> None:
    clouds = {ORB: cloud(square())}
    found, measured = with_distances(rows(ORB="incomplete", SIFT="error"), clouds.get, None)
    assert "reference" not in found[0]
    assert np.isnan(measured["ORB"].distances).all()
    assert list(measured) == ["ORB"]


@pytest.mark.parametrize("unit", ["m", "unit"])
@pytest.mark.parametrize("points", [square(), np.zeros((1, 3)), np.zeros((5, 3))])
def test_a_picture_shows_any_cloud(points: np.ndarray, unit: str) -> None:
    content = picture_of(cloud(points, unit), "SIFT-SIFT-L2-BF: 4 of 4 images")
    with Image.open(io.BytesIO(content)) as image:
        assert image.size == (1400, 760)
        assert len(image.getcolors(100_000) or ()) > 3
