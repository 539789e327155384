"""Calibrated intrinsics on synthetic models whose camera is known."""

from __future__ import annotations

from typing import Any

import numpy as np
import pycolmap
import pytest

from aerocues.reconstruction.calibration import (
    FOCAL_UNCERTAINTY,
    calibrations,
    told_calibration,
    with_calibrated,
)
from aerocues.reconstruction.colmap import camera_from_world, registered
from aerocues.reconstruction.scene import CameraGroup
from aerocues.results.metrics import Row

FOCAL, DISTORTION = 1280.0, 0.05
NOISE = 0.5
DOWN = np.diag([1.0, -1.0, -1.0])


def group_of(model: Any) -> CameraGroup:
    names = tuple(str(image.name) for image in registered(model))
    return CameraGroup("SIMPLE_RADIAL", (1200.0, 512.0, 384.0, 0.0), "EXIF", names)


def seen_from_all_sides(seed: int, frames: int = 6, points: int = 60) -> Any:
    """Noisy observations of points by cameras all around them."""
    pycolmap.set_random_seed(seed)
    options = pycolmap.SyntheticDatasetOptions()
    options.num_rigs, options.num_frames_per_rig, options.num_points3D = 1, frames, points
    options.num_points2D_without_point3D = 0
    options.camera_params = [FOCAL, 512.0, 384.0, DISTORTION]
    model = pycolmap.synthesize_dataset(options)
    noise = pycolmap.SyntheticNoiseOptions()
    noise.point2D_stddev = NOISE
    pycolmap.synthesize_noise(noise, model)
    return model


def seen_from_above(seed: int, relief: float) -> Any:
    """The same with ground of some relief and cameras that look straight down on it."""
    model = seen_from_all_sides(seed, frames=9, points=200)
    generator = np.random.default_rng(seed)
    for point in model.points3D.values():
        point.xyz = generator.uniform([-6, -4, 0], [6, 4, relief])
    for number, image in enumerate(registered(model)):
        centre = np.array([number % 3 - 1, number // 3 - 1, 20.0])
        pose = pycolmap.Rigid3d(np.column_stack([DOWN, -DOWN @ centre]))
        model.frame(image.frame_id).rig_from_world = pose
        for seen in image.points2D:
            if seen.has_point3D():
                exact = model.images[image.image_id].project_point(
                    model.points3D[seen.point3D_id].xyz
                )
                seen.xy = exact + generator.normal(scale=NOISE, size=2)
    return model


def by_hand(model: Any) -> float:
    """Standard deviation of the focal length over itself, from a dense numerical Jacobian."""
    images = registered(model)
    numbers = sorted(model.points3D)
    place = {number: position for position, number in enumerate(numbers)}
    camera = model.cameras[images[0].camera_id]
    observations = [
        (i, place[seen.point3D_id], seen.xy)
        for i, image in enumerate(images)
        for seen in image.points2D
        if seen.has_point3D()
    ]
    which = np.array([i for i, _, _ in observations])
    what = np.array([p for _, p, _ in observations])
    xy = np.array([each for _, _, each in observations])
    rotations, shifts = zip(*(camera_from_world(image) for image in images), strict=True)

    def residuals(values: np.ndarray) -> np.ndarray:
        focal, distortion = values[:2]
        turns, moves = np.split(values[2 : 2 + 6 * len(images)].reshape(-1, 6), 2, axis=1)
        points = values[2 + 6 * len(images) :].reshape(-1, 3)
        turned = np.einsum("nij,nj->ni", np.array(rotations)[which], points[what])
        turned = turned + np.cross(turns[which], turned) + moves[which]
        normal = turned[:, :2] / turned[:, 2:]
        radial = 1 + distortion * (normal**2).sum(axis=1, keepdims=True)
        found: np.ndarray = (focal * normal * radial + [512.0, 384.0] - xy).ravel()
        return found

    start = np.concatenate(
        [
            [camera.params[0], camera.params[3]],
            np.column_stack([np.zeros((len(images), 3)), np.array(shifts)]).ravel(),
            np.array([model.points3D[number].xyz for number in numbers]).ravel(),
        ]
    )
    steps = np.eye(len(start)) * 1e-6
    columns = [(residuals(start + step) - residuals(start - step)) / 2e-6 for step in steps]
    jacobian = np.column_stack(columns)
    freedom = len(observations) * 2 - (len(start) - 7)
    variance = (residuals(start) ** 2).sum() / freedom
    # The seven parameters of the frame are not determined: the pseudo-inverse leaves them out.
    covariance = np.linalg.pinv(jacobian.T @ jacobian, rcond=1e-13, hermitian=True)
    return float(np.sqrt(covariance[0, 0] * variance) / camera.params[0])


def only(model: Any) -> Row:
    [found] = calibrations(model, [group_of(model)])
    assert found is not None
    return found


def test_uncertainty_is_that_of_a_dense_adjustment() -> None:
    model = seen_from_all_sides(1)
    pycolmap.bundle_adjustment(model)
    assert only(model)["focal_uncertainty"] == pytest.approx(by_hand(model), rel=0.02)


def test_uncertainty_is_the_spread_of_what_is_found() -> None:
    found = [only(seen_from_all_sides(seed)) for seed in range(40)]
    errors = np.array([each["parameters"][0] / FOCAL - 1 for each in found])
    spreads = np.array([each["focal_uncertainty"] for each in found])
    assert 0.7 < np.sqrt(np.mean((errors / spreads) ** 2)) < 1.4
    assert np.abs(errors).max() < 0.02


def test_what_is_determined_takes_the_place_of_exif() -> None:
    model = seen_from_all_sides(3, frames=12, points=300)
    group = group_of(model)
    found = calibrations(model, [group])
    assert found[0] is not None
    assert found[0]["focal_uncertainty"] < FOCAL_UNCERTAINTY
    [camera] = with_calibrated([group], found)
    assert (camera.model, camera.source) == ("SIMPLE_RADIAL", "calibrated")
    assert camera.parameters[0] == pytest.approx(FOCAL, rel=0.005)
    assert camera.parameters[3] == pytest.approx(DISTORTION, abs=0.005)
    assert camera.names == group.names
    assert told_calibration([group], found).startswith("intrinsics: calibrated, 12")


def test_flat_ground_from_straight_above_does_not_determine_it() -> None:
    model = seen_from_above(4, relief=2.0)
    group = group_of(model)
    found = calibrations(model, [group])
    assert found[0] is not None
    assert found[0]["focal_uncertainty"] > 5 * FOCAL_UNCERTAINTY
    assert with_calibrated([group], found) == (group,)
    assert "do not determine" in told_calibration([group], found)

    flat = calibrations(seen_from_above(4, relief=0.3), [group])
    assert flat[0] is not None
    assert flat[0]["focal_uncertainty"] is None
    assert with_calibrated([group], flat) == (group,)
    assert "do not determine" in told_calibration([group], flat)


def test_a_camera_that_the_model_lacks_stays() -> None:
    model = seen_from_all_sides(5)
    other = CameraGroup("SIMPLE_RADIAL", (), "guessed", ("elsewhere.jpg",))
    found = calibrations(model, [other, group_of(model)])
    assert found[0] is None
    assert found[1] is not None
    assert with_calibrated([other, group_of(model)], found)[0] == other
    assert "a guess" in told_calibration([other], [None])


def test_the_model_stays_as_it_is() -> None:
    model = seen_from_all_sides(6)
    before = next(iter(model.cameras.values())).params.copy()
    only(model)
    np.testing.assert_array_equal(next(iter(model.cameras.values())).params, before)
