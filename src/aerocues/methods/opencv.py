"""OpenCV's features behind arrays.

Each stage is split in three: ``prepare`` turns arrays into OpenCV's objects, ``call`` is the one
call that is timed, ``read`` turns its result into arrays.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from aerocues.methods.arrays import Features, Keypoints, Matches, finite_features
from aerocues.methods.descriptors import DescriptorRow
from aerocues.methods.detectors import DetectorRow
from aerocues.methods.parameters import create_opencv

NORM_CONSTANTS = {"L2": cv2.NORM_L2, "HAM": cv2.NORM_HAMMING}


def to_opencv(keypoints: Keypoints) -> list[Any]:
    """Keypoints as a list of ``cv2.KeyPoint``, in the same order."""
    return [
        cv2.KeyPoint(*values)
        for values in zip(
            keypoints.xy[:, 0].tolist(),
            keypoints.xy[:, 1].tolist(),
            keypoints.size.tolist(),
            keypoints.angle.tolist(),
            keypoints.response.tolist(),
            keypoints.octave.tolist(),
            keypoints.class_id.tolist(),
            strict=True,
        )
    ]


def from_opencv(native: Sequence[Any]) -> Keypoints:
    """Keypoints from a sequence of ``cv2.KeyPoint``, in the same order."""
    count = len(native)
    values = np.array(
        [(*point.pt, point.size, point.angle, point.response) for point in native], np.float32
    ).reshape(count, 5)
    codes = np.array([(point.octave, point.class_id) for point in native], np.int32)
    codes = codes.reshape(count, 2)
    return Keypoints(
        xy=np.ascontiguousarray(values[:, :2]),
        size=values[:, 2].copy(),
        angle=values[:, 3].copy(),
        response=values[:, 4].copy(),
        octave=codes[:, 0].copy(),
        class_id=codes[:, 1].copy(),
    )


class OpenCVDetector:
    """A detector of OpenCV."""

    def __init__(self, row: DetectorRow) -> None:
        self._native = create_opencv(row.factory, row.parameters)

    def call(self, image: NDArray[np.uint8]) -> Any:
        return self._native.detect(image)

    def read(self, raw: Any) -> Keypoints:
        return from_opencv(raw)


class OpenCVDescriptor:
    """A descriptor of OpenCV."""

    def __init__(self, row: DescriptorRow) -> None:
        self._native = create_opencv(row.factory, row.parameters)
        self._dtype = np.dtype(row.dtype)
        self._columns = row.columns

    def prepare(self, keypoints: Keypoints) -> Any:
        return to_opencv(keypoints)

    def call(self, image: NDArray[np.uint8], prepared: Any) -> Any:
        return self._native.compute(image, prepared)

    def read(self, raw: Any) -> Features:
        """Features with the keypoints that ``compute`` returned, never those it was given.

        Rows that are not finite (KAZE on AKAZE keypoints gives some) are dropped.
        """
        native, descriptors = raw
        if descriptors is None or not len(native):
            return Features(from_opencv(()), np.empty((0, self._columns), self._dtype))
        return finite_features(from_opencv(native), descriptors)


class BruteForceMatcher:
    """Exact nearest neighbours, cross-checked (``cv2.BFMatcher``)."""

    def __init__(self, norm: str) -> None:
        self._native = cv2.BFMatcher(NORM_CONSTANTS[norm], crossCheck=True)

    def call(self, features_1: Features, features_2: Features) -> Any:
        return self._native.match(features_1.descriptors, features_2.descriptors)

    def read(self, raw: Any) -> Matches:
        return _from_dmatches(raw)


class FlannMatcher:
    """Approximate nearest neighbours in both directions (``cv2.FlannBasedMatcher``).

    The index is built anew in each direction and counts as matching. Only mutual matches stay.
    """

    def __init__(self, parameters: dict[str, Any]) -> None:
        index = dict(parameters)
        self._search = {"checks": index.pop("checks")}
        self._index = index

    def call(self, features_1: Features, features_2: Features) -> Any:
        first, second = features_1.descriptors, features_2.descriptors
        forth = cv2.FlannBasedMatcher(self._index, self._search).match(first, second)
        back = cv2.FlannBasedMatcher(self._index, self._search).match(second, first)
        return forth, back

    def read(self, raw: Any) -> Matches:
        forth, back = (_from_dmatches(matches) for matches in raw)
        if not len(forth) or not len(back):
            return Matches()
        answer = np.full(int(forth.indices[:, 1].max()) + 1, -1, np.int32)
        inside = back.indices[:, 0] < len(answer)
        answer[back.indices[inside, 0]] = back.indices[inside, 1]
        mutual = answer[forth.indices[:, 1]] == forth.indices[:, 0]
        return Matches(forth.indices[mutual], forth.distance[mutual])


def _from_dmatches(native: Sequence[Any]) -> Matches:
    indices = np.array([(match.queryIdx, match.trainIdx) for match in native], np.int32)
    distance = np.array([match.distance for match in native], np.float32)
    return Matches(indices.reshape(-1, 2), distance)
