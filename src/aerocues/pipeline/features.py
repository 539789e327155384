"""Features of images, computed once an image, detector and descriptor."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, TypeVar

import cv2
import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.dataset import Image, Pixels
from aerocues.errors import ImageError, MethodUnavailableError
from aerocues.methods.arrays import Features, Float32Array, Keypoints
from aerocues.methods.making import DescriptorStage, DetectorStage
from aerocues.methods.strongest import ALL_KEYPOINTS, KeypointLimit
from aerocues.pipeline.clock import Clock, StageTime
from aerocues.pipeline.turning import turned_keypoints, turned_pixels, turned_size

Result = TypeVar("Result")
WARM_UP_SIZE = 192
# Pixels that the widest corner detectors look at on either side.
BORDER = 5


class StageError(Exception):
    """A stage that did not give a result: the status of the rows that need it, and why."""

    def __init__(self, status: str, message: str | None) -> None:
        super().__init__(message)
        self.status = status
        self.message = message


@dataclass(frozen=True)
class Failure:
    """What is kept of a `StageError`: the traceback of an exception would hold all its memory.

    Parameters
    ----------
    status : str
    message : str or None
    """

    status: str
    message: str | None

    @classmethod
    def of(cls, error: StageError) -> Failure:
        """The part of an error that rows need."""
        return cls(error.status, error.message)


def unless_failed(found: Result | Failure) -> Result:
    """What was found; StageError where it is a failure."""
    if isinstance(found, Failure):
        raise StageError(found.status, found.message)
    return found


def run_stage(what: str, call: Callable[[], Result]) -> Result:
    """Call a method and turn whatever it raises into a StageError that names it."""
    try:
        return call()
    except MemoryError as error:
        raise StageError("out_of_memory", f"{what}: {error or 'not enough memory'}") from error
    except cv2.error as error:
        text = " ".join(str(error).split())
        memory = "Insufficient memory" in text or "bad_alloc" in text
        status = "out_of_memory" if memory else "error"
        raise StageError(status, f"{what}: {text}") from error
    except MethodUnavailableError as error:
        raise StageError("error", str(error)) from error
    except ImageError as error:
        raise StageError("error", str(error)) from error
    except Exception as error:  # a third-party method may raise anything, and costs only itself
        kind = type(error).__name__
        raise StageError("error", f"{what}: {kind}: {error}") from error


def warm_up(call: Callable[[], Any]) -> None:
    """Call a method on little, for what only the first call takes time for."""
    try:
        run_stage("warming up", call)
    except StageError:
        # The timed call right after fails the same way and is recorded.
        return


@dataclass(frozen=True)
class Described:
    """Features of one image under one descriptor, with the time that describing took."""

    features: Features
    time: StageTime


@dataclass
class ImageFeatures:
    """One image under one detector: pixels, keypoints and what descriptors made of them.

    Where the image is turned, ``keypoints`` are those of the turned one; what is described is
    turned back.
    """

    image: Image
    pixels: Pixels
    keypoints: Keypoints
    detect_time: StageTime
    described: dict[str, Described | Failure] = field(default_factory=dict)
    prepared: dict[type, Any] = field(default_factory=dict)

    @property
    def turn(self) -> int:
        """Degrees counterclockwise by which the image is turned."""
        return self.image.turn or 0

    @cached_property
    def seen(self) -> NDArray[np.uint8]:
        """What methods see: the image, turned."""
        return turned_pixels(self.pixels, self.turn).bgr

    @property
    def positions(self) -> Keypoints:
        """The keypoints in the image as it is."""
        return turned_keypoints(self.keypoints, turned_size(self.size, self.turn), -self.turn)

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels."""
        height, width = self.pixels.bgr.shape[:2]
        return width, height


def read_inner(image: Image) -> Pixels:
    """The pixels of an image, of which those are valid that keypoints may lie on.

    Raises
    ------
    ImageError
        If it cannot be decoded whole.
    """
    pixels = image.read()
    return Pixels(pixels.bgr, _inner(pixels.valid))


def _inner(valid: NDArray[np.bool_] | None) -> NDArray[np.bool_] | None:
    """The valid pixels away from the border: the edge of a warp looks like corners beside it."""
    if valid is None:
        return None
    kernel = np.ones((2 * BORDER + 1, 2 * BORDER + 1), np.uint8)
    return np.asarray(cv2.erode(valid.astype(np.uint8), kernel), bool)


def on_valid_pixels(keypoints: Keypoints, valid: NDArray[np.bool_] | None) -> Keypoints:
    """Drop keypoints on the border that a warp leaves: they are corners of no object."""
    if valid is None or not len(keypoints):
        return keypoints
    return keypoints.take(are_valid(keypoints.xy, valid))


def are_valid(xy: Float32Array, valid: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Whether (N, 2) positions lie on valid pixels."""
    height, width = valid.shape
    columns = np.clip(np.floor(xy[:, 0] + 0.5).astype(np.int64), 0, width - 1)
    rows = np.clip(np.floor(xy[:, 1] + 0.5).astype(np.int64), 0, height - 1)
    return np.asarray(valid[rows, columns])


class FeatureExtractor:
    """Runs detectors and descriptors, seeded, warmed up and timed one call at a time."""

    def __init__(self, clock: Clock, seed: int, limit: KeypointLimit = ALL_KEYPOINTS) -> None:
        self._clock = clock
        self._seed = seed
        self._limit = limit
        self._warm: set[tuple[str, str]] = set()

    def detect(self, image: Image, name: str, detector: DetectorStage) -> ImageFeatures:
        """Decode an image and detect its keypoints; StageError where that fails."""
        pixels = self._pixels(image)
        seen = turned_pixels(pixels, image.turn or 0)
        what = f"{name} detecting in {image.name}"
        if ("detector", name) not in self._warm:
            self._warm.add(("detector", name))
            warm_up(lambda: detector.call(centre(seen.bgr)))
        raw, time = run_stage(what, lambda: self._clock.time(lambda: detector.call(seen.bgr)))
        found = run_stage(what, lambda: detector.read(raw))
        kept = self._limit.keep(on_valid_pixels(found, seen.valid), self._seed)
        return ImageFeatures(image, pixels, kept, time)

    def read(self, image: Image, keypoints: Keypoints, detect_time: StageTime) -> ImageFeatures:
        """An image with keypoints that were detected before; StageError if it cannot be read."""
        return ImageFeatures(image, self._pixels(image), keypoints, detect_time)

    def _pixels(self, image: Image) -> Pixels:
        return run_stage(f"reading {image.name}", lambda: read_inner(image))

    def describe(
        self, image: ImageFeatures, name: str, what: str, descriptor: DescriptorStage
    ) -> Described:
        """Describe the keypoints of an image; StageError where that fails."""
        kind, bgr = type(descriptor), image.seen
        if kind not in image.prepared:
            image.prepared[kind] = run_stage(what, lambda: descriptor.prepare(image.keypoints, bgr))
        prepared = image.prepared[kind]
        if ("descriptor", name) not in self._warm and len(image.keypoints):
            self._warm.add(("descriptor", name))
            few = descriptor.prepare(image.keypoints.take(np.arange(1)), bgr)
            warm_up(lambda: descriptor.call(bgr, few))
        raw, time = run_stage(
            what, lambda: self._clock.time(lambda: descriptor.call(bgr, prepared))
        )
        found = run_stage(what, lambda: descriptor.read(raw))
        return Described(turned_back(found, image.size, image.turn), time)


def turned_back(features: Features, size: tuple[int, int], turn: int) -> Features:
    """Features of a turned image in the image as it is, whose size is given."""
    keypoints = turned_keypoints(features.keypoints, turned_size(size, turn), -turn)
    return replace(features, keypoints=keypoints, image_size=size, turn=turn)


def as_seen(features: Features) -> Features:
    """The other way round: features where methods saw them."""
    if not features.turn or features.image_size is None:
        return features
    size, turn = features.image_size, features.turn
    keypoints = turned_keypoints(features.keypoints, size, turn)
    return replace(features, keypoints=keypoints, image_size=turned_size(size, turn), turn=0)


def centre(bgr: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """The middle of an image, for what is called to warm up."""
    top = max((bgr.shape[0] - WARM_UP_SIZE) // 2, 0)
    left = max((bgr.shape[1] - WARM_UP_SIZE) // 2, 0)
    return np.ascontiguousarray(bgr[top : top + WARM_UP_SIZE, left : left + WARM_UP_SIZE])
