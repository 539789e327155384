from __future__ import annotations

from typing import Any

import cv2
import numpy as np
import pytest

from aerocues.simulation.camera import Pose, pinhole
from aerocues.simulation.lighting import Weather
from aerocues.simulation.rendering import Rendering, render
from aerocues.simulation.scene import Scene
from aerocues.simulation.scenes import stage
from aerocues.simulation.sensor import Sensor, develop

CAMERA = pinhole(500, 332, 90.0)


def features(rendering: Rendering, seed: int) -> tuple[Any, Any]:
    rgb = develop(rendering.radiance, Sensor(), np.random.default_rng(seed))
    gray = cv2.cvtColor(rgb, cv2.COLOR_RGB2GRAY)
    keypoints, descriptors = cv2.SIFT_create(5000).detectAndCompute(gray, None)
    return np.array([keypoint.pt for keypoint in keypoints]), descriptors


@pytest.mark.slow
def test_matches_agree_with_the_depth(suburb: Scene) -> None:
    # What shines moves from view to view: it tells nothing about where things are.
    dull = stage(suburb, Weather(glints=0.0))
    first, second = Pose(0, -5, -50, -90, 0), Pose(0, 5, -50, -90, 0)
    one, two = render(dull, CAMERA, first), render(dull, CAMERA, second)
    (points_1, descriptors_1), (points_2, descriptors_2) = features(one, 1), features(two, 2)
    matches = cv2.BFMatcher(cv2.NORM_L2, True).match(descriptors_1, descriptors_2)
    p = points_1[[match.queryIdx for match in matches]]
    q = points_2[[match.trainIdx for match in matches]]
    columns, rows = np.rint(p).astype(int).T
    x = (p[:, 0] - CAMERA.centre_x) / CAMERA.focal_x
    y = (p[:, 1] - CAMERA.centre_y) / CAMERA.focal_y
    rays = np.column_stack([x, y, np.ones(len(p))])
    world = rays * one.depth[rows, columns, None] @ first.rotation + first.centre
    seen = (world - second.centre) @ second.rotation.T
    u = seen[:, 0] / seen[:, 2] * CAMERA.focal_x + CAMERA.centre_x
    v = seen[:, 1] / seen[:, 2] * CAMERA.focal_y + CAMERA.centre_y
    errors = np.hypot(u - q[:, 0], v - q[:, 1])
    # At the edge of a roof or of a leaf a keypoint has two depths: the ground tells how exact
    # positions are.
    shape = np.ones((7, 7), np.uint8)
    span = cv2.dilate(one.depth, shape) - cv2.erode(one.depth, shape)
    right = (errors < 3.0) & (span[rows, columns] < 0.15)
    assert right.sum() > 150
    assert np.median(errors[right]) < 0.2
    # No shift in common: pixel centres mean the same to the renderer and to OpenCV.
    bias = np.median(np.column_stack([u, v])[right] - q[right], axis=0)
    assert np.abs(bias).max() < 0.08
