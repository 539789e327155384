"""The OpenCV calls that a run contains, and nothing else."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import cv2
import numpy as np

import aerocues
from aerocues.methods.arrays import Features, Keypoints
from aerocues.methods.exact.matching import mutual_nearest
from aerocues.methods.parameters import create_opencv
from aerocues.methods.registry import opencv_methods
from aerocues.methods.selection import select
from aerocues.pipeline.protocol import ChanceTest, MeasurementProtocol
from aerocues.pipeline.verification import magsac_parameters


class BareLoop:
    """Detect, describe, match and verify in plain loops.

    Parameters
    ----------
    spec : str
        Dataset.
    limit : int
        Pairs.
    naive : bool
        Whether every combination detects and describes for itself.
    exact : bool
        Whether exact search takes the place of brute force.
    max_width : int, optional
        To which wider images are shrunk, in pixels.
    """

    def __init__(
        self,
        spec: str,
        limit: int,
        *,
        naive: bool,
        exact: bool = False,
        max_width: int | None = None,
    ) -> None:
        cv2.setNumThreads(1)
        self._methods = opencv_methods()
        self._naive = naive
        self._exact = exact
        self._dataset = aerocues.open_dataset(spec, max_pairs=limit, max_width=max_width)
        verification = MeasurementProtocol().verification
        self._uniform = magsac_parameters(verification)
        self._guided = magsac_parameters(verification, guided=True)
        self._chance = ChanceTest()
        self._kept: dict[Any, Any] = {}
        self._native = {
            (kind, name): create_opencv(row.factory, row.parameters)
            for kind in ("detectors", "descriptors")
            for name, row in getattr(self._methods, kind).items()
        }

    def run(self, combinations: str) -> float:
        """CPU seconds that it took."""
        started = time.process_time()
        for pair in self._dataset.pairs:
            for combination in select(self._methods, combinations):
                self._evaluate(pair, combination)
        return time.process_time() - started

    def _once(self, key: tuple[str, ...], call: Callable[[], Any]) -> Any:
        if self._naive and key[0] != "image":
            return call()
        if key not in self._kept:
            self._kept[key] = call()
        return self._kept[key]

    def _features(self, name: str, detector: str, descriptor: str) -> Any:
        image = self._once(("image", name), lambda: self._dataset.image(name).read().bgr)
        found = self._once(
            ("detect", name, detector), lambda: self._native["detectors", detector].detect(image)
        )
        keypoints, rows = self._once(
            ("describe", name, detector, descriptor),
            lambda: _computed(self._native["descriptors", descriptor], image, found),
        )
        if rows is None or rows.dtype != np.float32:
            return keypoints, rows
        return keypoints, np.nan_to_num(rows)

    def _match(self, combination: Any, first: Any, second: Any) -> tuple[Any, Any]:
        """Indices (M, 2) and distances (M,)."""
        if combination.matcher == "BF" and self._exact:
            features = [
                Features(Keypoints.from_xy(np.zeros((len(rows), 2))), rows)
                for rows in (first, second)
            ]
            found = mutual_nearest(*features, combination.norm)
            return found.indices, found.distance
        matches = self._by_opencv(combination, first, second)
        indices = np.array([(match.queryIdx, match.trainIdx) for match in matches], np.intp)
        return indices.reshape(-1, 2), np.array([match.distance for match in matches])

    def _by_opencv(self, combination: Any, first: Any, second: Any) -> list[Any]:
        if combination.matcher == "BF":
            norm = cv2.NORM_L2 if combination.norm == "L2" else cv2.NORM_HAMMING
            return list(cv2.BFMatcher(norm, crossCheck=True).match(first, second))
        parameters = dict(self._methods.matchers["FLANN"].parameters[combination.norm])
        search = {"checks": parameters.pop("checks")}
        forth = cv2.FlannBasedMatcher(parameters, search).match(first, second)
        back = cv2.FlannBasedMatcher(parameters, search).match(second, first)
        answer = {match.queryIdx: match.trainIdx for match in back}
        return [match for match in forth if answer.get(match.trainIdx) == match.queryIdx]

    def _beats_chance(self, points_1: Any, points_2: Any, parameters: Any) -> bool:
        inliers = _inliers(points_1, points_2, parameters)
        shuffled = []
        for shuffle in range(self._chance.shuffles):
            order = np.random.default_rng((0, shuffle)).permutation(len(points_2))
            other = np.ascontiguousarray(points_2[order])
            shuffled.append(_inliers(points_1, other, parameters))
        return bool(inliers > self._chance.factor * max(shuffled))

    def _evaluate(self, pair: Any, combination: Any) -> None:
        detector, descriptor = combination.detector, combination.descriptor
        keypoints_1, first = self._features(pair.image_1, detector, descriptor)
        keypoints_2, second = self._features(pair.image_2, detector, descriptor)
        if first is None or second is None or not len(first) or not len(second):
            return
        indices, distances = self._match(combination, first, second)
        if len(indices) < MeasurementProtocol().verification.minimum_matches:
            return
        points_1 = np.asarray(cv2.KeyPoint_convert(keypoints_1))[indices[:, 0]]
        points_2 = np.asarray(cv2.KeyPoint_convert(keypoints_2))[indices[:, 1]]
        if not self._beats_chance(points_1, points_2, self._uniform):
            order = np.argsort(distances)
            self._beats_chance(points_1[order], points_2[order], self._guided)
        if pair.homography is not None:
            cv2.findHomography(points_1, points_2, self._uniform)


def _computed(descriptor: Any, image: Any, keypoints: Any) -> Any:
    """Keypoints and descriptors; none where OpenCV refuses the keypoints."""
    try:
        return descriptor.compute(image, keypoints)
    except cv2.error:
        return (), None


def _inliers(points_1: Any, points_2: Any, parameters: Any) -> int:
    """Inliers of a fundamental matrix; none where all samples are degenerate."""
    try:
        mask = cv2.findFundamentalMat(points_1, points_2, parameters)[1]
    except cv2.error:
        return 0
    return 0 if mask is None else int(mask.sum())
