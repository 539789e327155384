"""From rows of the tables to objects that detect, describe and match."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from aerocues.errors import MethodUnavailableError
from aerocues.methods.arrays import DescriptorArray, Features, Keypoints, Matches, finite_features
from aerocues.methods.combination import NONE
from aerocues.methods.descriptors import DescriptorRow
from aerocues.methods.matchers import NormRow
from aerocues.methods.opencv import (
    BruteForceMatcher,
    FlannMatcher,
    Latch,
    LevelDescriptor,
    OpenCVDescriptor,
    OpenCVDetector,
    RootSift,
)
from aerocues.methods.pair_matching import ArrayPairMatcher
from aerocues.methods.parameters import AEROCUES, OPENCV, Value
from aerocues.methods.plugins import load_factory
from aerocues.methods.positions import EXACT_POSITIONS
from aerocues.methods.registry import Methods


class DetectorStage(Protocol):
    """A detector whose ``call`` is timed apart from the conversion of its result."""

    def call(self, image: NDArray[np.uint8]) -> Any: ...
    def read(self, raw: Any) -> Keypoints: ...


class DescriptorStage(Protocol):
    """A descriptor whose ``call`` is timed apart from the conversions around it."""

    def prepare(self, keypoints: Keypoints, image: NDArray[np.uint8]) -> Any: ...
    def call(self, image: NDArray[np.uint8], prepared: Any) -> Any: ...
    def read(self, raw: Any) -> Features: ...


class MatcherStage(Protocol):
    """A matcher whose ``call`` is timed apart from the conversion of its result."""

    def call(self, features_1: Features, features_2: Features) -> Any: ...
    def read(self, raw: Any) -> Matches: ...


OPENCV_MATCHERS: Mapping[str, Callable[[NormRow, Mapping[str, Value]], MatcherStage]] = {
    "BFMatcher": BruteForceMatcher,
    "FlannBasedMatcher": FlannMatcher,
}
"""What runs each class of OpenCV that rows of the table of matchers name."""


OWN_DESCRIPTORS: Mapping[str, Callable[[DescriptorRow], DescriptorStage]] = {
    "ROOTSIFT": RootSift,
}
"""What aerocues makes of OpenCV's descriptors."""
MENDED_DESCRIPTORS: Mapping[str, Callable[[DescriptorRow], DescriptorStage]] = {"LATCH": Latch}
"""Descriptors of OpenCV by factory that need more than to be called."""


@dataclass(frozen=True, eq=False)
class ExtractedKeypoints(Keypoints):
    """Keypoints of an extractor, which bring their descriptors along."""

    descriptors: DescriptorArray

    def take(self, which: NDArray[np.bool_] | NDArray[np.integer[Any]]) -> ExtractedKeypoints:
        kept = super().take(which)
        return ExtractedKeypoints(**vars(kept), descriptors=self.descriptors[which])


class ArrayDetector:
    """A third-party detector or extractor."""

    def __init__(self, native: Any) -> None:
        self._call = native.extract if hasattr(native, "extract") else native.detect

    def call(self, image: NDArray[np.uint8]) -> Any:
        return self._call(image)

    def read(self, raw: Any) -> Keypoints:
        keypoints = raw.keypoints if isinstance(raw, Features) else raw
        if not isinstance(keypoints, Keypoints):
            raise TypeError(f"a detector returns Keypoints, not {type(raw).__name__}")
        if not np.isfinite(keypoints.xy).all():
            raise ValueError("a detector returned positions that are not finite")
        if isinstance(raw, Features):
            return ExtractedKeypoints(**vars(keypoints), descriptors=raw.descriptors)
        return keypoints


class ArrayDescriptor:
    """A third-party descriptor, or the descriptors that an extractor found already."""

    def __init__(self, native: Any, dtype: str) -> None:
        self._native = native
        self._dtype = dtype

    def prepare(self, keypoints: Keypoints, image: NDArray[np.uint8]) -> Any:
        return keypoints

    def call(self, image: NDArray[np.uint8], prepared: Any) -> Any:
        if isinstance(prepared, ExtractedKeypoints):
            return Features(prepared, prepared.descriptors)
        return self._native.describe(image, prepared)

    def read(self, raw: Any) -> Features:
        if not isinstance(raw, Features):
            raise TypeError(f"a descriptor returns Features, not {type(raw).__name__}")
        if raw.descriptors.dtype != self._dtype:
            packed = "; pack bits: numpy.packbits(bits, axis=1)"
            told = f"descriptors of {raw.descriptors.dtype}, declared as {self._dtype}"
            raise TypeError(told + (packed if raw.descriptors.dtype == bool else ""))
        contiguous: Any = np.ascontiguousarray(raw.descriptors)
        return finite_features(raw.keypoints, contiguous)


class ArrayMatcher:
    """A third-party matcher."""

    def __init__(self, native: Any, norm: str) -> None:
        self._native = native
        self._norm = norm

    def call(self, features_1: Features, features_2: Features) -> Any:
        counts = (len(features_1), len(features_2))
        return self._native.match(features_1, features_2, self._norm), counts

    def read(self, raw: Any) -> Matches:
        matches, counts = raw
        if not isinstance(matches, Matches):
            raise TypeError(f"a matcher returns Matches, not {type(matches).__name__}")
        if not ((matches.indices >= 0) & (matches.indices < counts)).all():
            raise ValueError("a matcher returned the index of a feature that does not exist")
        for column in (0, 1):
            if len(np.unique(matches.indices[:, column])) != len(matches):
                raise ValueError("a matcher returned a feature twice; matches are one to one")
        return matches


def _plugin(factory: str, parameters: dict[str, Any]) -> Any:
    try:
        return load_factory(factory)(**parameters)
    except ImportError as error:
        raise MethodUnavailableError(f"{factory} needs what is not installed: {error}") from error


def make_detector(methods: Methods, name: str) -> DetectorStage:
    """Make the detector `name`; MethodUnavailableError where it cannot be made."""
    row = methods.detectors[name]
    if row.origin in (OPENCV, AEROCUES):
        return OpenCVDetector(row)
    return ArrayDetector(_plugin(row.factory, dict(row.parameters)))


def make_descriptor(methods: Methods, name: str, detector: str = "") -> DescriptorStage:
    """Make the descriptor `name` for the keypoints of a detector.

    MethodUnavailableError where it cannot be made.
    """
    row = methods.descriptor_on(name, detector)
    if row.origin == AEROCUES:
        return OWN_DESCRIPTORS[row.name](row)
    if row.origin == OPENCV:
        usual = LevelDescriptor if row.parameters.get(EXACT_POSITIONS) else OpenCVDescriptor
        return MENDED_DESCRIPTORS.get(row.factory, usual)(row)
    return ArrayDescriptor(_plugin(row.factory, dict(row.parameters)), row.dtype)


def make_pair_matcher(methods: Methods, name: str) -> ArrayPairMatcher:
    """Make the pair matcher `name`; MethodUnavailableError where it cannot be made."""
    row = methods.matchers[name]
    return ArrayPairMatcher(_plugin(row.factory, dict(row.parameters.get(NONE, {}))))


def make_matcher(methods: Methods, name: str, norm: str) -> MatcherStage:
    """Make the matcher `name` for a norm; MethodUnavailableError where it cannot be made."""
    row = methods.matchers[name]
    parameters = dict(row.parameters.get(norm, {}))
    if row.origin != OPENCV:
        return ArrayMatcher(_plugin(row.factory, parameters), norm)
    if row.factory not in OPENCV_MATCHERS:
        raise MethodUnavailableError(
            f"the matcher {name} is made by {row.factory!r}, which aerocues does not know; "
            f"use {' or '.join(OPENCV_MATCHERS)} in its row"
        )
    return OPENCV_MATCHERS[row.factory](methods.norms[norm], parameters)
