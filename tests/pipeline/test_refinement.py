"""Least-squares matching on views of a random texture, whose true positions are known."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from aerocues.methods.arrays import Float32Array, Matches
from aerocues.pipeline.local_motion import jacobians, local_motion
from aerocues.pipeline.patch_matching import as_gray, gaussian_weights, match_patches
from aerocues.pipeline.refinement import RefinedKeypoints, refine_tracks

pytestmark = pytest.mark.slow

Floats = NDArray[np.float64]
SIZE = (420, 300)
NOISE = 0.8


def similarity(degrees: float, scale: float, x: float, y: float) -> Floats:
    """A view's pixels in the texture: turned, scaled, and its middle at (x, y)."""
    cosine, sine = (scale * part(np.radians(degrees)) for part in (np.cos, np.sin))
    linear = np.array([[cosine, -sine], [sine, cosine]])
    shift = np.array([x, y]) - linear @ ((np.array(SIZE) - 1) / 2)
    return np.vstack([np.column_stack([linear, shift]), [0, 0, 1]])


VIEWS = (
    similarity(0, 1, 350, 300),
    similarity(180, 1.04, 357.3, 305.6),
    similarity(8, 0.96, 344.7, 292.2),
)


@cache
def texture() -> NDArray[np.uint8]:
    random = np.random.default_rng(0)
    smooth = cv2.GaussianBlur(random.normal(0, 1, (600, 700)), (0, 0), 1.5)
    gray: NDArray[np.uint8] = np.clip(400 * np.asarray(smooth) + 128, 0, 255).astype(np.uint8)
    return gray


@cache
def view(number: int, gain: float = 1.0, bias: float = 0.0) -> NDArray[np.uint8]:
    flags = cv2.INTER_CUBIC | cv2.WARP_INVERSE_MAP
    seen = np.asarray(cv2.warpPerspective(texture(), VIEWS[number], SIZE, flags=flags))
    changed: NDArray[np.uint8] = np.clip(gain * seen + bias, 0, 255).astype(np.uint8)
    return changed


def through(matrix: Any, points: Any) -> Floats:
    mapped = np.column_stack([points, np.ones(len(points))]) @ matrix.T
    return np.asarray(mapped[:, :2] / mapped[:, 2:])


@dataclass(frozen=True)
class Scene:
    """Where points lie in each view, where they were found, and which are matched."""

    true: list[Floats]
    found: list[Float32Array]
    pairs: dict[tuple[int, int], Matches]

    def errors(self, xy: Sequence[NDArray[Any]]) -> Floats:
        """How far the points of two views are apart in the texture, in pixels."""
        there = [through(matrix, each) for matrix, each in zip(VIEWS, xy, strict=True)]
        apart = [np.linalg.norm(each - there[0], axis=1) for each in there[1:]]
        return np.concatenate(apart)


@cache
def scene(noise: float = NOISE, count: int = 400) -> Scene:
    random = np.random.default_rng(1)
    world = random.uniform([200, 200], [500, 400], (count, 2))
    true = [through(np.linalg.inv(matrix), world) for matrix in VIEWS]
    found = [(each + random.normal(0, noise, each.shape)).astype(np.float32) for each in true]
    everyone = np.column_stack([np.arange(count)] * 2).astype(np.int32)
    distance = random.random(count).astype(np.float32)
    pairs = {pair: Matches(everyone, distance) for pair in ((0, 1), (0, 2), (1, 2))}
    return Scene(true, found, pairs)


def refined(scene: Scene, *, gain: float = 1.0, bias: float = 0.0) -> RefinedKeypoints:
    def gray(number: int) -> Float32Array:
        return as_gray(view(number, gain, bias) if number == 1 else view(number), 0.5)

    return refine_tracks(gray, scene.found, scene.pairs)


def test_keypoints_that_are_off_by_a_pixel_come_to_a_thirtieth() -> None:
    made, found = scene(), refined(scene())
    before = np.median(made.errors(made.found))
    assert before > 1
    assert np.median(made.errors(found.xy)) < before / 30
    assert found.observations == 800
    assert found.accepted > 0.99 * found.observations
    assert not np.concatenate(found.rejected).sum() > 8
    assert found.shift is not None
    assert 0.7 < found.shift < 2.1


def test_what_neighbours_say_tells_the_precision_before_and_after() -> None:
    made, found = scene(), refined(scene())
    assert found.disagreement_before == pytest.approx(np.median(made.errors(made.found)), rel=0.2)
    assert found.disagreement is not None
    assert found.disagreement < 0.05


def test_other_brightness_and_contrast_change_nothing_much() -> None:
    made = scene()
    found = refined(made, gain=0.6, bias=30)
    assert np.median(made.errors(found.xy)) < 0.04


def test_the_same_arguments_give_the_same_bytes() -> None:
    first, second = refined(scene()), refined(scene())
    assert all((a == b).all() for a, b in zip(first.xy, second.xy, strict=True))
    assert first.disagreement == second.disagreement


def test_references_and_unmatched_keypoints_stay() -> None:
    made = scene()
    few = {
        pair: Matches(each.indices[:300], each.distance[:300]) for pair, each in made.pairs.items()
    }
    found = refined(replace(made, pairs=few))
    moved = np.array([(a != b).any(axis=1) for a, b in zip(found.xy, made.found, strict=True)])
    assert not moved[:, 300:].any()
    assert (moved[:, :300].sum(axis=0) <= 2).all()


def test_what_is_hidden_is_rejected_and_stays_where_it_was() -> None:
    made = scene()

    def gray(number: int) -> Float32Array:
        image = view(number).copy()
        if number == 2:
            image[:, :140] = 90
        return as_gray(image, 0.5)

    found = refine_tracks(gray, made.found, made.pairs)
    hidden = made.found[2][:, 0] < 135
    stayed = (found.xy[2] == made.found[2]).all(axis=1)
    assert hidden.sum() > 30
    assert stayed[hidden].all()
    others = ~hidden & (made.found[2][:, 0] > 160)
    assert found.rejected[2][others].mean() < 0.02
    assert sum(each.sum() for each in found.rejected) >= hidden.sum()


def test_those_that_are_too_far_off_start_again_where_neighbours_say_they_lie() -> None:
    made = scene()
    off = [each.copy() for each in made.found]
    off[1][:60] += np.float32(4)
    shaken = replace(made, found=off)
    found = refined(shaken)
    assert found.accepted > found.accepted_at_once + 40
    assert np.median(made.errors(found.xy)[:60]) < 0.05


def test_an_image_that_shows_nothing_has_nothing_to_hold_on_to() -> None:
    made = scene()
    plain = np.full(SIZE[::-1], 90, np.float32)
    found = refine_tracks(lambda number: plain, made.found, made.pairs)
    assert found.accepted == 0
    assert found.shift is None
    assert found.disagreement is None
    assert all((a == b).all() for a, b in zip(found.xy, made.found, strict=True))


def test_keypoints_of_shrunk_images_are_refined_on_the_full_ones() -> None:
    made = scene()
    halved = [((each + 0.5) / 2 - 0.5).astype(np.float32) for each in made.found]
    found = refine_tracks(lambda number: as_gray(view(number), 0.5), halved, made.pairs, scale=2.0)
    full = [((each + 0.5) * 2 - 0.5).astype(np.float32) for each in found.xy]
    assert np.median(made.errors(full)) < 0.05
    assert found.shift is not None
    assert 0.7 < 2 * found.shift < 2.1


def test_without_matches_nothing_happens() -> None:
    made = scene()
    found = refine_tracks(lambda number: as_gray(view(number), 0.5), made.found, {})
    assert (found.observations, found.accepted, found.shift) == (0, 0, None)
    assert all((a == b).all() for a, b in zip(found.xy, made.found, strict=True))


def test_a_patch_is_found_where_it_was_moved_to() -> None:
    image = as_gray(texture(), 0.5)
    moved = np.asarray(
        cv2.warpAffine(image, np.array([[1, 0, 3.25], [0, 1, -1.5]]), image.shape[::-1])
    )
    points = np.array([[200.0, 200.0], [301.4, 250.7], [3.0, 3.0]])
    warps = np.tile(np.eye(2), (3, 1, 1))
    shifts, likeness = match_patches(
        image, moved, points, points + np.array([2.0, -1.0]), warps, gaussian_weights(8, 4.0), 15
    )
    np.testing.assert_allclose(shifts[:2], [[1.25, -0.5]] * 2, atol=0.03)
    assert likeness[:2].min() > 0.98
    assert likeness[2] == -1  # too near to the border


def test_the_steps_of_a_homography_are_its_derivatives() -> None:
    homography = np.array([[1.1, 0.2, 5], [-0.1, 0.9, 7], [1e-4, -2e-4, 1]])
    at, step = np.array([[100.0, 50.0]]), 1e-5
    numeric = np.stack(
        [
            (through(homography, at + axis * step) - through(homography, at - axis * step))[0]
            / (2 * step)
            for axis in np.eye(2)
        ],
        axis=1,
    )
    np.testing.assert_allclose(jacobians(homography, at)[0], numeric, rtol=1e-5)


def test_neighbours_tell_an_affine_map_in_spite_of_a_wrong_one() -> None:
    random = np.random.default_rng(2)
    first = random.uniform(-60, 60, (12, 2)) + np.array([200, 100])
    linear, shift = np.array([[0.9, 0.3], [-0.2, 1.1]]), np.array([40.0, -7.0])
    second = first @ linear.T + shift
    second[4] += 30
    at = np.array([[200.0, 100.0]])
    maps, places = local_motion(first, second, np.arange(12)[None], at, linear[None], 1.0)
    np.testing.assert_allclose(maps[0], linear, atol=0.02)
    np.testing.assert_allclose(places[0], linear @ at[0] + shift, atol=0.1)
