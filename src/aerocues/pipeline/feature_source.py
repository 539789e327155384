"""Features of images under any combination: each is made once, or taken from a folder."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np

from aerocues.datasets.dataset import Image
from aerocues.methods.arrays import Features, Keypoints
from aerocues.methods.combination import Combination
from aerocues.methods.making import DescriptorStage, DetectorStage, make_descriptor, make_detector
from aerocues.methods.registry import Methods
from aerocues.pipeline.clock import NO_TIME, Clock
from aerocues.pipeline.feature_cache import FeatureCache, Key
from aerocues.pipeline.feature_folder import FeatureFolder
from aerocues.pipeline.features import (
    Described,
    Failure,
    FeatureExtractor,
    ImageFeatures,
    StageError,
    run_stage,
    unless_failed,
)
from aerocues.pipeline.protocol import MeasurementProtocol
from aerocues.processes.call import NO_PAIR, StageCall

Announce = Callable[[StageCall], None]


def silent(_: StageCall) -> None:
    """Announce nothing."""


@dataclass(frozen=True, eq=False)
class TimedFeatures:
    """Features of an image and the CPU seconds that they took."""

    features: Features
    seconds: float


class FeatureSource:
    """Detects and describes; methods are made once and kept.

    Parameters
    ----------
    methods : Methods
    protocol : MeasurementProtocol
        Seed, limit of keypoints and timing.
    clock : Clock
    folder : FeatureFolder, optional
        Where features are kept for other runs, and taken from.
    announce : callable
        Called with each stage call before it begins.
    """

    def __init__(
        self,
        methods: Methods,
        protocol: MeasurementProtocol,
        clock: Clock,
        *,
        folder: FeatureFolder | None = None,
        announce: Announce = silent,
    ) -> None:
        cv2.setNumThreads(1)
        self._methods = methods
        self._extractor = FeatureExtractor(clock, protocol.seed, protocol.limit)
        self._folder = folder
        self._announce = announce
        self._cache = FeatureCache()
        self._detectors: dict[str, DetectorStage] = {}
        self._descriptors: dict[str, DescriptorStage] = {}

    @property
    def problem(self) -> str | None:
        """Why features are no longer kept in the folder, if they are not."""
        return self._folder.problem if self._folder else None

    def detected(self, image: Image, detector: str, pair: int = NO_PAIR) -> ImageFeatures | Failure:
        """An image with its keypoints, or why there are none; it stays in memory until `trim`.

        Parameters
        ----------
        image : Image
        detector : str
        pair : int
            The pair that is worked on, for `announce`.
        """
        key = (detector, image.name)
        found = self._cache.get(key)
        if found is None:
            self._announce(StageCall("detect", pair, image.name, detector))
            try:
                found = self._detect(image, detector)
            except StageError as error:
                found = Failure.of(error)
            self._cache.put(key, found)
        return found

    def described(
        self, found: ImageFeatures, combination: Combination, pair: int = NO_PAIR
    ) -> Described:
        """The features of an image under the descriptor of a combination, made once.

        Raises
        ------
        StageError
            If the descriptor fails on these keypoints.
        """
        name = combination.descriptor
        if name not in found.described:
            image = found.image
            self._announce(StageCall("describe", pair, image.name, combination.detector, name))
            try:
                found.described[name] = self._describe(found, combination)
            except StageError as error:
                found.described[name] = Failure.of(error)
        return unless_failed(found.described[name])

    def features(self, image: Image, combination: Combination) -> TimedFeatures:
        """The features of an image; it is not decoded where the folder has them.

        Raises
        ------
        StageError
            If the image cannot be read or a method fails.
        """
        kept = self._kept(image, combination)
        if kept is not None:
            return kept
        found = unless_failed(self.detected(image, combination.detector))
        seconds = found.detect_time.cpu
        if not len(found.keypoints):
            row = self._methods.descriptors[combination.descriptor]
            nothing = np.empty((0, max(row.columns, 1)), row.dtype)
            nowhere = Features(found.keypoints, nothing, found.size, found.turn)
            return TimedFeatures(nowhere, seconds)
        described = self.described(found, combination)
        return TimedFeatures(described.features, seconds + described.time.cpu)

    def trim(self, needed: frozenset[Key] = frozenset()) -> None:
        """Drop from memory what is not needed and does not fit."""
        self._cache.trim(needed)

    def forget(self) -> None:
        """Drop all features from memory: other images may come under the same names."""
        self._cache = FeatureCache()

    def _kept(self, image: Image, combination: Combination) -> TimedFeatures | None:
        if self._folder is None:
            return None
        detected = self._folder.keypoints(image, combination.detector)
        described = self._folder.described(image, combination.detector, combination.descriptor)
        if detected is None or described is None:
            return None
        return TimedFeatures(described.features, detected[1].cpu + described.time.cpu)

    def _detect(self, image: Image, name: str) -> ImageFeatures:
        if self._methods.detectors[name].of_pairs:
            return self._extractor.read(image, Keypoints.from_xy(np.empty((0, 2))), NO_TIME)
        kept = self._folder.keypoints(image, name) if self._folder else None
        if kept is not None:
            return self._extractor.read(image, *kept)
        if name not in self._detectors:
            self._detectors[name] = run_stage(name, lambda: make_detector(self._methods, name))
        found = self._extractor.detect(image, name, self._detectors[name])
        if self._folder:
            self._folder.keep_keypoints(image, name, found.keypoints, found.detect_time)
        return found

    def _describe(self, found: ImageFeatures, combination: Combination) -> Described:
        detector, name, image = combination.detector, combination.descriptor, found.image
        kept = self._folder.described(image, detector, name) if self._folder else None
        if kept is not None:
            return kept
        what = f"{name} describing {detector} keypoints of {image.name}"
        described = self._extractor.describe(found, name, what, self._descriptor(name, detector))
        if self._folder:
            self._folder.keep_described(image, detector, name, described)
        return described

    def _descriptor(self, name: str, detector: str) -> DescriptorStage:
        both = f"{detector}-{name}"
        own = both if both in self._methods.on_detectors else name
        if own not in self._descriptors:
            self._descriptors[own] = run_stage(
                name, lambda: make_descriptor(self._methods, name, detector)
            )
        return self._descriptors[own]
