"""Small pictures with something for every detector, and keypoints found in them."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from aerocues.methods.arrays import Keypoints
from aerocues.methods.making import make_detector
from aerocues.methods.registry import Methods

ATTEMPTS = 8
FIELDS = ("xy", "size", "angle", "response", "octave", "class_id")


def textured(width: int = 200, height: int = 150, seed: int = 0) -> NDArray[np.uint8]:
    """A BGR picture of coloured blobs and blocks of many sizes, slightly smoothed and noisy."""
    random = np.random.default_rng(seed)
    canvas = np.full((height, width, 3), 110, np.uint8)
    for size in (34, 22, 14, 9, 6):
        for _ in range(max(width * height // (size * size * 3), 4)):
            x, y = (int(v) for v in random.integers((0, 0), (width, height)))
            colour = tuple(int(v) for v in random.integers(0, 256, 3))
            half = (size // 2, max(int(size * random.uniform(0.25, 0.5)), 1))
            if random.random() < 0.5:
                corners = cv2.boxPoints(((x, y), (2.0 * half[0], 2.0 * half[1]), x + y))
                cv2.fillConvexPoly(canvas, np.rint(corners).astype(np.int32), colour)
            else:
                cv2.ellipse(canvas, (x, y), half, float(x), 0, 360, colour, -1)
    smooth = cv2.GaussianBlur(canvas, (0, 0), 0.8).astype(np.float64)
    noisy = smooth + random.normal(0, 2.0, smooth.shape)
    result: NDArray[np.uint8] = np.clip(np.rint(noisy), 0, 255).astype(np.uint8)
    return result


def shifted_pair(
    width: int = 200, height: int = 150, shift: tuple[int, int] = (7, 4), seed: int = 0
) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    """Two windows of one picture: what lies at (x, y) in the first lies at (x, y) - shift."""
    whole = textured(width + shift[0], height + shift[1], seed)
    first = np.ascontiguousarray(whole[:height, :width])
    second = np.ascontiguousarray(whole[shift[1] :, shift[0] :])
    return first, second


def strongest(keypoints: Keypoints, count: int) -> Keypoints:
    """At most `count` keypoints of the greatest response, in the order they were found."""
    order = np.argsort(-keypoints.response, kind="stable")[:count]
    return keypoints.take(np.sort(order))


def detect(methods: Methods, name: str, image: NDArray[np.uint8], folder: Path) -> Keypoints:
    """Keypoints of `image`; a detector that may kill its process runs in another one."""
    if not methods.detectors[name].unstable:
        detector = make_detector(methods, name)
        return detector.read(detector.call(image))
    source, target = folder / "image.npy", folder / f"{name}.npz"
    np.save(source, image)
    parameters = json.dumps(dict(methods.detectors[name].parameters))
    for _ in range(ATTEMPTS):
        done = subprocess.run(
            [sys.executable, "-c", _ELSEWHERE, name, parameters, str(source), str(target)],
            env={"PYTHONPATH": ":".join(filter(None, sys.path))},
            capture_output=True,
            check=False,
        )
        if done.returncode == 0:
            stored = np.load(target)
            return Keypoints(*(stored[field] for field in FIELDS))
    raise AssertionError(f"{name} died {ATTEMPTS} times: {done.stderr.decode()[-500:]}")


_ELSEWHERE = """
import dataclasses, json, sys, numpy
from aerocues.methods.detectors import DETECTORS
from aerocues.methods.opencv import OpenCVDetector
name, parameters, source, target = sys.argv[1:]
row = next(row for row in DETECTORS if row.name == name)
detector = OpenCVDetector(dataclasses.replace(row, parameters=json.loads(parameters)))
found = detector.read(detector.call(numpy.load(source)))
numpy.savez(target, **{field: getattr(found, field) for field in found.__dataclass_fields__})
"""
