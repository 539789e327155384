"""A reference tells right matches from wrong ones, with nothing but the two images to go by."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from aerocues.datasets import geometry
from aerocues.datasets.dataset import Dataset, Pixels
from aerocues.datasets.true_geometry import Located
from aerocues.errors import MethodUnavailableError
from aerocues.evaluation.depth_correspondence import DepthCorrespondence
from aerocues.pipeline import reference
from aerocues.pipeline.correspondence import PlaneCorrespondence, transfer
from aerocues.pipeline.reference import FLOW, Reference, ReferenceBuilder
from aerocues.pipeline.reference_flow import FlowCorrespondence, find_flow
from aerocues.pipeline.reference_seeds import Seeds
from tests.methods.pictures import textured
from tests.reconstruction.scenes import write_scene

SIZE = (320, 240)


def build(first: Pixels, second: Pixels) -> Reference:
    builder = ReferenceBuilder()
    return builder.build(builder.prepare(first), builder.prepare(second))


def correspondence(found: Reference, first: Pixels, second: Pixels) -> FlowCorrespondence:
    made = found.correspondence(first, second)
    assert made is not None, found.verdict
    return made


def points_in(size: tuple[int, int], count: int = 400, border: int = 12) -> NDArray[np.float32]:
    generator = np.random.default_rng(0)
    low, high = (border, border), (size[0] - border, size[1] - border)
    return generator.uniform(low, high, (count, 2)).astype(np.float32)


def warped(matrix: NDArray[np.float64], seed: int = 0) -> tuple[Pixels, Pixels]:
    """A picture, and what a homography makes of it."""
    picture = textured(*SIZE, seed=seed)
    return Pixels(picture), Pixels(
        np.ascontiguousarray(cv2.warpPerspective(picture, matrix, SIZE, flags=cv2.INTER_LINEAR))
    )


@pytest.fixture(scope="module")
def tilted() -> tuple[Pixels, Pixels, NDArray[np.float64]]:
    matrix = np.array([[0.96, -0.08, 21.0], [0.06, 1.02, -9.0], [1e-4, -6e-5, 1.0]])
    return *warped(matrix), matrix


@pytest.fixture(scope="module")
def of_tilted(tilted: tuple[Pixels, Pixels, NDArray[np.float64]]) -> Reference:
    return build(*tilted[:2])


@pytest.fixture(scope="module")
def landscape(tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    return write_scene(tmp_path_factory.mktemp("landscape"), [(-3.0, 0.0), (3.0, 0.0)])


def test_points_of_a_plane_are_put_where_they_lie(
    tilted: tuple[Pixels, Pixels, NDArray[np.float64]], of_tilted: Reference
) -> None:
    first, second, matrix = tilted
    assert of_tilted.verdict == FLOW
    assert of_tilted.agreement is not None
    assert 0.9 < of_tilted.agreement <= 1
    points = points_in(SIZE)
    true = transfer(points, matrix)
    seen = ((true > 12) & (true < np.array(SIZE) - 12)).all(axis=1)
    found = correspondence(of_tilted, first, second)
    errors = found.errors(points[seen], true[seen])
    assert np.median(errors) < 0.3
    assert (errors < 1).mean() > 0.97
    # What is wrong by so much is told to be wrong by so much.
    aside = found.errors(points[seen], true[seen] + (6, -8))
    np.testing.assert_allclose(aside[errors < 1], 10, atol=1)


def test_points_outside_are_right_nowhere(
    tilted: tuple[Pixels, Pixels, NDArray[np.float64]], of_tilted: Reference
) -> None:
    found = correspondence(of_tilted, *tilted[:2])
    outside = np.array([[-1.0, 50], [50, SIZE[1] + 1.0]], np.float32)
    assert np.isinf(found.errors(outside, outside)).all()
    assert found.errors(outside[:0], outside[:0]).shape == (0,)


def test_covisible_points_are_those_of_the_truth(
    tilted: tuple[Pixels, Pixels, NDArray[np.float64]], of_tilted: Reference
) -> None:
    first, second, matrix = tilted
    points = points_in(SIZE, border=0)
    found = correspondence(of_tilted, first, second).shared(points, points)
    truth = PlaneCorrespondence(matrix, first, second).shared(points, points)
    for mine, expected in zip(found, truth, strict=True):
        assert len(mine) == pytest.approx(len(expected), abs=6)


def test_relief_is_followed(landscape: Dataset) -> None:
    first, second = (Pixels(image.read().bgr) for image in landscape.images)
    views = landscape.true_views(landscape.pairs[0])
    assert views is not None
    truth = DepthCorrespondence(*(Located.of(view) for view in views))
    found = correspondence(build(first, second), first, second)
    points = points_in((480, 360), 1000)
    moved, _ = truth.shared(points, points)
    flat = transfer(points, found.flow.homography)
    seen = ((flat > 5) & (flat < (475, 355))).all(axis=1)
    at = found.flow.moved(points[seen])
    errors = truth.errors(points[seen], at.astype(np.float32))
    assert (errors < 1).mean() > 0.85
    # A plane alone is wrong on the roofs.
    plane = truth.errors(points[seen], flat[seen].astype(np.float32))
    assert (errors < 3).mean() > (plane < 3).mean() + 0.05
    assert len(moved) > 500


def test_the_same_images_give_the_same_reference(
    tilted: tuple[Pixels, Pixels, NDArray[np.float64]], of_tilted: Reference
) -> None:
    before = cv2.getNumThreads()
    try:
        for threads in (1, 2):
            cv2.setNumThreads(threads)
            cv2.setRNGSeed(threads)
            again = build(*tilted[:2])
            assert again.agreement == of_tilted.agreement
            assert again.flow is not None
            assert of_tilted.flow is not None
            for name, array in vars(of_tilted.flow).items():
                np.testing.assert_array_equal(getattr(again.flow, name), array)
    finally:
        cv2.setNumThreads(before)


def test_images_of_different_things_have_no_reference() -> None:
    found = build(Pixels(textured(*SIZE, seed=1)), Pixels(textured(*SIZE, seed=2)))
    assert found.verdict != FLOW
    assert found.flow is None
    assert found.turn is None
    assert found.correspondence(Pixels(textured(*SIZE)), Pixels(textured(*SIZE))) is None


def test_few_seeds_and_seeds_of_the_same_pixel_make_a_flow() -> None:
    """OpenCV's interpolator reads foreign memory where a seed lacks neighbours."""
    first, second = warped(np.array([[1.0, 0.0, 4.0], [0.0, 1.0, -3.0], [0.0, 0.0, 1.0]]))
    points = np.random.default_rng(0).uniform(20, 200, (20, 2)).astype(np.float32)
    points = np.concatenate([points, points[:12]])
    moved = points + np.array((4, -3), np.float32)
    flow = find_flow(first, second, Seeds(points, moved))
    assert np.abs(flow.moved(points) - moved).max() < 0.5


@pytest.mark.parametrize("picture", ["black", "tiny"])
def test_images_without_content_have_no_reference(picture: str) -> None:
    size = SIZE if picture == "black" else (12, 9)
    empty = Pixels(np.zeros((size[1], size[0], 3), np.uint8))
    assert build(empty, Pixels(textured(*SIZE))).flow is None


def test_a_flow_that_the_seeds_contradict_is_not_trusted(
    tilted: tuple[Pixels, Pixels, NDArray[np.float64]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(reference, "AGREEING", -1.0)
    found = build(*tilted[:2])
    assert found.flow is None
    assert found.agreement == 0
    assert "only 0%" in found.verdict


@pytest.mark.parametrize("degrees", [90, 180, 270])
def test_an_image_may_be_turned(degrees: int) -> None:
    picture = Pixels(textured(*SIZE, seed=3))
    turned = geometry.warp(picture, "rotation", degrees)
    matrix, _ = geometry.placement("rotation", degrees, SIZE)
    found = build(picture, turned)
    assert found.turn == pytest.approx(min(degrees, 360 - degrees), abs=0.5)
    points = points_in(SIZE)
    errors = correspondence(found, picture, turned).errors(points, transfer(points, matrix))
    assert (errors < 1).mean() > 0.97


def test_an_image_that_is_not_turned_has_a_turn_of_nothing(of_tilted: Reference) -> None:
    # atan2(0.06 + 0.08, 0.96 + 1.02) before the perspective.
    assert of_tilted.turn == pytest.approx(4.0, abs=1)


def test_nothing_is_looked_for_on_what_is_not_valid() -> None:
    picture = Pixels(textured(*SIZE, seed=4))
    turned = geometry.warp(picture, "rotation", 30)
    assert turned.valid is not None
    inner = Pixels(turned.bgr, cv2.erode(turned.valid.astype(np.uint8), np.ones((11, 11))) > 0)
    builder = ReferenceBuilder()
    first, second = builder.prepare(picture), builder.prepare(inner)
    for features in second.features:
        columns, rows = np.rint(features.keypoints.xy).astype(int).T
        assert inner.valid is not None
        assert inner.valid[rows, columns].all()
    found = correspondence(builder.build(first, second), picture, inner)
    corners = np.array([[2, 2], [inner.bgr.shape[1] - 3, 3]], np.float32)
    _, seen = found.shared(points_in(SIZE), corners)
    assert len(seen) == 0
    points = points_in(SIZE, border=20)
    matrix, _ = geometry.placement("rotation", 30, SIZE)
    assert (found.errors(points, transfer(points, matrix)) < 1).mean() > 0.95


def test_wide_images_are_halved(
    tilted: tuple[Pixels, Pixels, NDArray[np.float64]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(reference, "LARGEST", 200)
    first, second, matrix = tilted
    found = build(first, second)
    assert found.flow is not None
    assert found.flow.steps.shape == (120, 160, 2)
    points = points_in(SIZE)
    true = transfer(points, matrix)
    seen = ((true > 12) & (true < np.array(SIZE) - 12)).all(axis=1)
    errors = correspondence(found, first, second).errors(points[seen], true[seen])
    assert np.median(errors) < 0.6
    assert (errors < 2).mean() > 0.95


def test_a_build_of_opencv_without_what_it_needs_is_named(
    tilted: tuple[Pixels, Pixels, NDArray[np.float64]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delattr(cv2, "ximgproc")
    with pytest.raises(MethodUnavailableError):
        build(*tilted[:2])


def test_the_reference_of_a_pair_of_files(tmp_path: Path) -> None:
    """What is decoded from files is what is built of."""
    picture = textured(*SIZE, seed=6)
    assert cv2.imwrite(str(tmp_path / "a.png"), picture)
    read = cv2.imread(str(tmp_path / "a.png"))
    found = build(Pixels(np.asarray(read, np.uint8)), Pixels(picture))
    assert found.agreement == 1
    assert found.turn == pytest.approx(0, abs=0.01)
