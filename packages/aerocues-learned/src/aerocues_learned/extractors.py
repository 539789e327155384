"""XFEAT and ALIKED: detector and descriptor in one network."""

from __future__ import annotations

from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from aerocues import Features, Keypoints
from aerocues_learned.images import (
    CELL,
    Float32Array,
    fitted_size,
    in_original_pixels,
    padded_to_cells,
    resized,
)
from aerocues_learned.sessions import CPU, Network
from aerocues_learned.weights import FOLDER


class LearnedExtractor:
    """What XFEAT and ALIKED share.

    Parameters
    ----------
    count : int
        The strongest keypoints that are kept in an image.
    threshold : float
        The score that a keypoint must exceed.
    longest_side : int
        Pixels; larger images are made smaller for the network, 0 never does that. Memory grows
        with the pixels.
    provider : str
        ONNX Runtime's name of what computes.
    """

    dtype = "float32"
    on_request = "learned"
    # What aerocues keeps of an image at most, the network need not describe more.
    limit = "count"
    # None of them estimates the orientation of a keypoint.
    upright = True
    parameters: ClassVar[dict[str, Any]]
    graph: ClassVar[str]

    def __init__(self, count: int, threshold: float, longest_side: int, provider: str) -> None:
        self._count = count
        self._threshold = threshold
        self._longest_side = longest_side
        self._provider = provider

    def extract(self, image: NDArray[np.uint8]) -> Features:
        """Features of `image`, (H, W, 3) uint8 in BGR order, the strongest first."""
        raise NotImplementedError

    # Loaded by the first call, which warms up and is not timed: an extractor is made twice, as
    # detector and as descriptor, and the descriptor never computes.
    @cached_property
    def _network(self) -> Network:
        return Network(FOLDER / self.graph, self._provider)

    @staticmethod
    def _features(xy: Float32Array, score: Float32Array, descriptors: Float32Array) -> Features:
        neutral = Keypoints.from_xy(xy)
        keypoints = Keypoints(**{**vars(neutral), "response": np.asarray(score, np.float32)})
        return Features(keypoints, np.ascontiguousarray(descriptors, np.float32))


class XFeat(LearnedExtractor):
    """XFEAT: keypoints at whole pixels, 64 numbers each."""

    reference = (
        "Potje et al., XFeat: accelerated features for lightweight image matching, CVPR 2024"
    )
    parameters: ClassVar = {
        "count": 4096,
        "threshold": 0.05,
        "longest_side": 1600,
        "provider": CPU,
    }
    graph = "xfeat.onnx"

    def extract(self, image: NDArray[np.uint8]) -> Features:
        """Features of `image`, (H, W, 3) uint8 in BGR order; the network sees the mean colour."""
        fitted = fitted_size(image, self._longest_side)
        size = (max(fitted[0] // CELL, 1) * CELL, max(fitted[1] // CELL, 1) * CELL)
        gray = resized(image.mean(axis=2, dtype=np.float32), size)
        xy, score, descriptors = self._network(
            gray=gray[None, None],
            count=np.array(self._count, np.int64),
            threshold=np.array(self._threshold, np.float32),
        )
        return self._features(in_original_pixels(xy, size, image), score, descriptors)


class Aliked(LearnedExtractor):
    """What both ALIKED networks share: keypoints between pixels."""

    reference = (
        "Zhao et al., ALIKED: a lighter keypoint and descriptor extraction network, TIM 2023"
    )
    parameters: ClassVar = {
        "count": 4096,
        "threshold": 0.01,
        "longest_side": 1600,
        "provider": CPU,
    }

    def extract(self, image: NDArray[np.uint8]) -> Features:
        """Features of `image`, (H, W, 3) uint8 in BGR order."""
        size = fitted_size(image, self._longest_side)
        padded, (left, top) = padded_to_cells(resized(image, size))
        rgb = padded[..., ::-1].transpose(2, 0, 1)[None].astype(np.float32) / 255
        xy, score, descriptors = self._network(
            image=rgb,
            crop=np.array([left, top, *size], np.int64),
            count=np.array(self._count, np.int64),
            threshold=np.array(self._threshold, np.float32),
        )
        return self._features(in_original_pixels(xy, size, image), score, descriptors)


class AlikedT16(Aliked):
    """ALIKED_T16: the smallest network, 64 numbers a keypoint."""

    graph = "aliked-t16.onnx"


class AlikedN16Rot(Aliked):
    """ALIKED_N16ROT: trained with turned images, 128 numbers a keypoint."""

    graph = "aliked-n16rot.onnx"
