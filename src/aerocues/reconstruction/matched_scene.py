"""Keypoints and matches of a scene, in memory and as a file that is kept after the descriptors."""

from __future__ import annotations

import io
import zipfile
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aerocues.methods.arrays import Float32Array, Int32Array, Keypoints
from aerocues.results.whole_files import write_whole

Names = tuple[str, str]
BROKEN = (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile, zlib.error)


@dataclass(frozen=True, eq=False)
class PairMatches:
    """Mutual matches of a pair.

    Parameters
    ----------
    indices : (M, 2) int32
        Indices of keypoints in the first and the second image.
    distance : (M,) float32
        Distance of the descriptors.
    """

    indices: Int32Array
    distance: Float32Array

    def chosen(self, wanted: NDArray[np.bool_]) -> PairMatches:
        """Those of (M,) bool."""
        return PairMatches(self.indices[wanted], self.distance[wanted])

    def __len__(self) -> int:
        return len(self.indices)


@dataclass(frozen=True, eq=False)
class MatchedScene:
    """Keypoints by image and matches by pair, with their CPU seconds."""

    keypoints: Mapping[str, Keypoints]
    pairs: Mapping[Names, PairMatches]
    feature_seconds: float
    matching_seconds: float

    def points(self, pair: Names) -> tuple[Float32Array, Float32Array]:
        """Positions of the matched keypoints, (M, 2) pixels each."""
        indices = self.pairs[pair].indices
        first, second = (self.keypoints[name].xy for name in pair)
        return first[indices[:, 0]], second[indices[:, 1]]

    def write(self, file: Path, key: str) -> None:
        """Store it with the key of its settings; OSError if the disk is full."""
        content = io.BytesIO()
        keypoints, matches = list(self.keypoints.values()), list(self.pairs.values())
        np.savez_compressed(
            content,
            key=np.array(key),
            images=np.array(list(self.keypoints)),
            pairs=np.array(list(self.pairs)).reshape(-1, 2),
            keypoint_counts=np.array([len(each) for each in keypoints]),
            match_counts=np.array([len(each) for each in matches]),
            xy=_joined([each.xy for each in keypoints], (0, 2), np.float32),
            size=_joined([each.size for each in keypoints], (0,), np.float32),
            angle=_joined([each.angle for each in keypoints], (0,), np.float32),
            indices=_joined([each.indices for each in matches], (0, 2), np.int32),
            distance=_joined([each.distance for each in matches], (0,), np.float32),
            seconds=np.array([self.feature_seconds, self.matching_seconds]),
        )
        write_whole({file: content.getbuffer()})


def _joined(parts: list[Any], shape: tuple[int, ...], dtype: Any) -> NDArray[Any]:
    return np.concatenate([np.empty(shape, dtype), *parts])


def read_matched_scene(file: Path, key: str) -> MatchedScene | None:
    """The stored scene with the same key; None if it is missing or damaged."""
    if not file.is_file():
        return None
    try:
        with np.load(file, allow_pickle=False) as stored:
            if str(stored["key"]) != key:
                return None
            arrays = dict(stored)
    except BROKEN:
        return None
    return _scene_of(arrays)


def _scene_of(arrays: Mapping[str, NDArray[Any]]) -> MatchedScene:
    bounds = np.cumsum(arrays["keypoint_counts"])[:-1]
    parts = zip(*(np.split(arrays[name], bounds) for name in ("xy", "size", "angle")), strict=True)
    keypoints = {
        str(name): _keypoints(*part) for name, part in zip(arrays["images"], parts, strict=True)
    }
    bounds = np.cumsum(arrays["match_counts"])[:-1]
    parts = zip(*(np.split(arrays[name], bounds) for name in ("indices", "distance")), strict=True)
    pairs = {
        (str(first), str(second)): PairMatches(*part)
        for (first, second), part in zip(arrays["pairs"], parts, strict=True)
    }
    feature_seconds, matching_seconds = arrays["seconds"].tolist()
    return MatchedScene(keypoints, pairs, feature_seconds, matching_seconds)


def _keypoints(xy: Float32Array, size: Float32Array, angle: Float32Array) -> Keypoints:
    count = len(xy)
    return Keypoints(
        xy,
        size,
        angle,
        np.zeros(count, np.float32),
        np.zeros(count, np.int32),
        np.full(count, -1, np.int32),
    )
