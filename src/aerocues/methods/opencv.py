"""OpenCV's features behind arrays.

Each stage is split in three: ``prepare`` turns arrays into OpenCV's objects, ``call`` is the one
call that is timed, ``read`` turns its result into arrays.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import chain
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from aerocues.errors import MethodUnavailableError
from aerocues.methods.arrays import Features, Int32Array, Keypoints, Matches, finite_features
from aerocues.methods.descriptors import DescriptorRow
from aerocues.methods.detectors import DetectorRow
from aerocues.methods.matchers import NormRow
from aerocues.methods.parameters import Value, create_opencv
from aerocues.methods.positions import (
    EXACT_POSITIONS,
    GRAY_INPUT,
    OWN_PARAMETERS,
    PYRAMIDS,
    Size,
)

HALF_PATCH = 24
"""Pixels from a keypoint to the farthest centre of what LATCH compares."""
ROWS_BELOW = 2
"""One that LATCH may read, and one behind it, where it reads a pixel too far to the right, too."""
SEARCH_PARAMETERS = ("checks", "eps", "sorted", "explore_all_trees")


def _create(row: DetectorRow | DescriptorRow) -> Any:
    """OpenCV's object of a row, made with the parameters that OpenCV knows."""
    known = {name: value for name, value in row.parameters.items() if name not in OWN_PARAMETERS}
    return create_opencv(row.factory, known)


def _size(image: NDArray[np.uint8]) -> Size:
    return image.shape[1], image.shape[0]


class OpenCVDetector:
    """A detector of OpenCV; its keypoints are put where they really are, if its row asks that."""

    def __init__(self, row: DetectorRow) -> None:
        self._native = _create(row)
        self._parameters = row.parameters
        self._gray = bool(row.parameters.get(GRAY_INPUT))
        self._pyramid = PYRAMIDS[row.factory] if row.parameters.get(EXACT_POSITIONS) else None

    def call(self, image: NDArray[np.uint8]) -> Any:
        if self._gray and image.ndim == 3:
            image = np.asarray(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), np.uint8)
        return self._native.detect(image), _size(image)

    def read(self, raw: Any) -> Keypoints:
        native, size = raw
        found = Keypoints.from_opencv(native)
        if self._pyramid is None or not len(found):
            return found
        return self._pyramid.exact(found, size, self._parameters)


class OpenCVDescriptor:
    """A descriptor of OpenCV."""

    def __init__(self, row: DescriptorRow) -> None:
        self._native = _create(row)
        self._dtype = np.dtype(row.dtype)
        self._columns = row.columns

    def prepare(self, keypoints: Keypoints, image: NDArray[np.uint8]) -> Any:
        return keypoints.to_opencv()

    def call(self, image: NDArray[np.uint8], prepared: Any) -> Any:
        return self._native.compute(image, prepared)

    def read(self, raw: Any) -> Features:
        """Features with the keypoints that ``compute`` returned, never those it was given.

        Rows that are not finite (KAZE on AKAZE keypoints gives some) are dropped.
        """
        native, descriptors = raw
        if descriptors is None or not len(native):
            return Features(Keypoints.from_opencv(()), np.empty((0, self._columns), self._dtype))
        return finite_features(Keypoints.from_opencv(native), descriptors)


class RootSift(OpenCVDescriptor):
    """The SIFT descriptor, as the square root of its share of the whole (L1): RootSIFT."""

    def call(self, image: NDArray[np.uint8], prepared: Any) -> Any:
        native, descriptors = super().call(image, prepared)
        if descriptors is None:
            return native, None
        whole = np.maximum(descriptors.sum(axis=1, keepdims=True), np.finfo(np.float32).tiny)
        return native, np.sqrt(descriptors / whole)


class Latch(OpenCVDescriptor):
    """LATCH, kept from reading below the image.

    It rounds 534.5 down to ask whether a keypoint is far enough from the border, and up to describe
    it. Then it reads one row too low: memory whose content differs from call to call. More rows,
    mirrored as its blur mirrors them, change nothing else.
    """

    def __init__(self, row: DescriptorRow) -> None:
        super().__init__(row)
        self._border = HALF_PATCH + int(row.parameters.get("half_ssd_size", 3))

    def prepare(self, keypoints: Keypoints, image: NDArray[np.uint8]) -> Any:
        lowest = image.shape[0] - self._border
        inside = np.flatnonzero(np.rint(keypoints.xy[:, 1]) < lowest)
        return super().prepare(keypoints.take(inside), image)

    def call(self, image: NDArray[np.uint8], prepared: Any) -> Any:
        taller = cv2.copyMakeBorder(image, 0, ROWS_BELOW, 0, 0, cv2.BORDER_REFLECT_101)
        return super().call(np.asarray(taller, np.uint8), prepared)


class LevelDescriptor(OpenCVDescriptor):
    """A descriptor of OpenCV that looks for keypoints on levels of a pyramid, at a wrong place.

    It is told other positions, with which it looks at the right one; ``class_id``, which it does
    not read, carries the number of the keypoint.
    """

    def __init__(self, row: DescriptorRow) -> None:
        super().__init__(row)
        self._pyramid = PYRAMIDS[row.factory]
        self._parameters = row.parameters

    def prepare(self, keypoints: Keypoints, image: NDArray[np.uint8]) -> Any:
        told = self._pyramid.as_found(keypoints, _size(image), self._parameters)
        numbered = replace(told, class_id=np.arange(len(told), dtype=np.int32))
        return keypoints, super().prepare(numbered, image)

    def call(self, image: NDArray[np.uint8], prepared: Any) -> Any:
        keypoints, told = prepared
        return keypoints, super().call(image, told)

    def read(self, raw: Any) -> Features:
        keypoints, described = raw
        features = super().read(described)
        numbers: Int32Array = features.keypoints.class_id
        return Features(keypoints.take(numbers), features.descriptors)


class BruteForceMatcher:
    """Exact nearest neighbours, cross-checked (``cv2.BFMatcher``)."""

    def __init__(self, norm: NormRow, parameters: Mapping[str, Value]) -> None:
        try:
            constant = getattr(cv2, norm.constant)
            self._native = cv2.BFMatcher(constant, crossCheck=True, **parameters)
        except (cv2.error, TypeError, AttributeError) as error:
            raise MethodUnavailableError(
                f"OpenCV {cv2.__version__} cannot match by brute force under {norm.constant} with "
                f"{dict(parameters)}: {str(error).strip()}; correct the row of the norm or matcher"
            ) from error

    def call(self, features_1: Features, features_2: Features) -> Any:
        return self._native.match(features_1.descriptors, features_2.descriptors)

    def read(self, raw: Any) -> Matches:
        return _from_dmatches(raw)


class FlannMatcher:
    """Approximate nearest neighbours in both directions (``cv2.FlannBasedMatcher``).

    The index is built anew in each direction and counts as matching. Only mutual matches stay.
    The algorithm of the index decides the norm.
    """

    def __init__(self, norm: NormRow, parameters: Mapping[str, Value]) -> None:
        self._search: dict[str, Any] = {}
        self._index: dict[str, Any] = {}
        for name, value in parameters.items():
            kind = self._search if name in SEARCH_PARAMETERS else self._index
            kind[name] = value

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
    rows = ((match.queryIdx, match.trainIdx, match.distance) for match in native)
    values = np.fromiter(chain.from_iterable(rows), np.float64, 3 * len(native)).reshape(-1, 3)
    return Matches(values[:, :2].astype(np.int32), values[:, 2].astype(np.float32))
