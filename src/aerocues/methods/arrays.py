"""Keypoints, features and matches as plain arrays: what every method takes and returns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import NDArray

Float32Array = NDArray[np.float32]
Int32Array = NDArray[np.int32]
DescriptorArray = NDArray[np.uint8] | NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class Keypoints:
    """Keypoints of one image.

    Parameters
    ----------
    xy : (N, 2) float32
        Pixels; the centre of the top-left pixel is (0, 0), x to the right, y down.
    size, angle, response : (N,) float32
        Diameter in pixels; orientation in degrees clockwise, -1 where there is none; strength.
    octave, class_id : (N,) int32
        As OpenCV defines them (SIFT packs octave, layer and sub-layer into ``octave``).
    """

    xy: Float32Array
    size: Float32Array
    angle: Float32Array
    response: Float32Array
    octave: Int32Array
    class_id: Int32Array

    def __post_init__(self) -> None:
        if self.xy.ndim != 2 or self.xy.shape[1] != 2:
            raise ValueError(f"xy must have shape (N, 2), not {self.xy.shape}")
        for name in ("size", "angle", "response", "octave", "class_id"):
            if getattr(self, name).shape != (len(self.xy),):
                raise ValueError(f"{name} must have shape ({len(self.xy)},)")

    def __len__(self) -> int:
        return len(self.xy)

    def __repr__(self) -> str:
        return f"Keypoints: {len(self):,}"

    @classmethod
    def from_xy(cls, xy: NDArray[np.floating[Any]], size: float = 31.0) -> Keypoints:
        """Keypoints of which only the positions are known; the rest takes neutral values."""
        points = np.ascontiguousarray(xy, dtype=np.float32).reshape(-1, 2)
        count = len(points)
        return cls(
            xy=points,
            size=np.full(count, size, np.float32),
            angle=np.full(count, -1, np.float32),
            response=np.zeros(count, np.float32),
            octave=np.zeros(count, np.int32),
            class_id=np.full(count, -1, np.int32),
        )

    @classmethod
    def from_opencv(cls, native: Sequence[Any]) -> Keypoints:
        """Keypoints from a sequence of ``cv2.KeyPoint``, in the same order."""
        rows = (
            (*point.pt, point.size, point.angle, point.response, point.octave, point.class_id)
            for point in native
        )
        # Doubles hold every float32 and int32 exactly.
        values = np.fromiter(chain.from_iterable(rows), np.float64, 7 * len(native)).reshape(-1, 7)
        size, angle, response = values[:, 2:5].T.astype(np.float32)
        octave, class_id = values[:, 5:].T.astype(np.int32)
        xy = np.ascontiguousarray(values[:, :2], np.float32)
        return cls(xy, size, angle, response, octave, class_id)

    def to_opencv(self) -> list[Any]:
        """The keypoints as a list of ``cv2.KeyPoint``, in the same order."""
        import cv2

        columns = (*self.xy.T, self.size, self.angle, self.response, self.octave, self.class_id)
        values = zip(*(column.tolist() for column in columns), strict=True)
        return [cv2.KeyPoint(*each) for each in values]

    def take(self, which: NDArray[np.bool_] | NDArray[np.integer[Any]]) -> Keypoints:
        """The keypoints selected by a mask or by indices, in that order."""
        return Keypoints(
            self.xy[which],
            self.size[which],
            self.angle[which],
            self.response[which],
            self.octave[which],
            self.class_id[which],
        )


@dataclass(frozen=True, eq=False)
class Features:
    """Keypoints with one descriptor each: the keypoints that the descriptor returned.

    Parameters
    ----------
    keypoints : Keypoints
        N keypoints.
    descriptors : (N, D) uint8 or float32
    image_size : tuple of int, optional
        Width and height in pixels of the image in which `keypoints` lie. Matchers are always told;
        what extractors and descriptors say of it is not used.
    turn : int
        Degrees counterclockwise by which the image was turned when they were found. `keypoints`
        are turned back; matchers are given those of the turned image, with its size.
    """

    keypoints: Keypoints
    descriptors: DescriptorArray
    image_size: tuple[int, int] | None = None
    turn: int = 0

    def __post_init__(self) -> None:
        if self.descriptors.ndim != 2 or len(self.descriptors) != len(self.keypoints):
            raise ValueError(
                f"{len(self.keypoints)} keypoints need descriptors of shape "
                f"({len(self.keypoints)}, D), not {self.descriptors.shape}"
            )

    def __len__(self) -> int:
        return len(self.keypoints)

    def __repr__(self) -> str:
        kind = f"{self.descriptors.shape[1]} {self.descriptors.dtype}"
        return f"Features: {len(self):,} keypoints with descriptors of {kind}"

    def take(self, which: NDArray[np.bool_] | NDArray[np.integer[Any]]) -> Features:
        """The features selected by a mask or by indices, in that order."""
        return replace(
            self, keypoints=self.keypoints.take(which), descriptors=self.descriptors[which]
        )


def finite_features(keypoints: Keypoints, descriptors: DescriptorArray) -> Features:
    """Features without the rows whose descriptor is not finite: nothing can match those."""
    finite = np.asarray(np.isfinite(descriptors).all(axis=1))
    found = Features(keypoints, descriptors)
    return found if finite.all() else found.take(finite)


@dataclass(frozen=True, eq=False)
class Matches:
    """Mutual matches between two sets of features.

    Parameters
    ----------
    indices : (M, 2) int32
        Row in the first and in the second features.
    distance : (M,) float32
        Descriptor distance; its unit is that of the norm.
    """

    indices: Int32Array = field(default_factory=lambda: np.empty((0, 2), np.int32))
    distance: Float32Array = field(default_factory=lambda: np.empty(0, np.float32))

    def __post_init__(self) -> None:
        if self.indices.ndim != 2 or self.indices.shape[1] != 2:
            raise ValueError(f"indices must have shape (M, 2), not {self.indices.shape}")
        if self.distance.shape != (len(self.indices),):
            raise ValueError(f"distance must have shape ({len(self.indices)},)")

    def __len__(self) -> int:
        return len(self.indices)

    def __repr__(self) -> str:
        return f"Matches: {len(self):,}"
