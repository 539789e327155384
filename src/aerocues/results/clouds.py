"""Sparse clouds of reconstructions with their cameras, as small files in the results folder."""

from __future__ import annotations

import io
import zipfile
import zlib
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aerocues.errors import StoreError
from aerocues.expansion import why_too_large

# What numpy and zipfile raise for damaged files; NotImplementedError and RuntimeError are for
# entries that seem to be compressed in another way, or encrypted.
UNREADABLE = (
    OSError,
    ValueError,
    KeyError,
    EOFError,
    MemoryError,
    NotImplementedError,
    RuntimeError,
    zipfile.BadZipFile,
    zlib.error,
)
Float32Array = NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class Cloud:
    """The points and cameras of one model.

    If positions of the images are known, the frame is east, north, up in metres; otherwise it is
    that of the model.

    Parameters
    ----------
    points : (N, 3) float32
    colours : (N, 3) uint8
        Red, green, blue; gray if they were not taken from the images.
    errors : (N,) float32
        Mean reprojection error in pixels.
    track_lengths : (N,) int32
        Number of images that see the point.
    distances : (N,) float32
        Distance to the nearest point of the reference cloud; NaN if there is no reference.
    centres : (C, 3) float32
        Centres of the cameras.
    rotations : (C, 3, 3) float32
        Rotation from the camera (x right, y down, z forward) to the frame of the points.
    names : (C,) str
        Names of the images.
    positions : (C, 3) float32
        True centres, from GPS or known poses; NaN where unknown.
    view : (3,) float32
        Focal length, width and height of the first camera in pixels.
    unit : str
        ``m``, or ``unit`` if the scale is unknown.
    """

    points: Float32Array
    colours: NDArray[np.uint8]
    errors: Float32Array
    track_lengths: NDArray[np.int32]
    distances: Float32Array
    centres: Float32Array
    rotations: Float32Array
    names: NDArray[np.str_]
    positions: Float32Array
    view: Float32Array
    unit: str

    def __post_init__(self) -> None:
        count, cameras = len(self.points), len(self.centres)
        shapes = {
            "points": (count, 3),
            "colours": (count, 3),
            "errors": (count,),
            "track_lengths": (count,),
            "distances": (count,),
            "centres": (cameras, 3),
            "rotations": (cameras, 3, 3),
            "names": (cameras,),
            "positions": (cameras, 3),
            "view": (3,),
        }
        for name, shape in shapes.items():
            if getattr(self, name).shape != shape:
                raise ValueError(f"{name} must have shape {shape}, not {getattr(self, name).shape}")

    def with_distances(self, distances: NDArray[np.floating[Any]]) -> Cloud:
        """The same cloud with other distances to the reference."""
        return replace(self, distances=np.asarray(distances, np.float32))

    def content(self) -> bytes:
        """The content of a file with this cloud; equal clouds give equal bytes."""
        file = io.BytesIO()
        arrays: dict[str, Any] = {
            field.name: np.asarray(getattr(self, field.name)) for field in fields(self)
        }
        np.savez_compressed(file, **arrays)  # zip entries without a date
        return file.getvalue()


def read_cloud(content: bytes, where: str | Path) -> Cloud:
    """The cloud from the content of a file; StoreError if it is damaged."""
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            expanded = sum(member.file_size for member in archive.infolist())
        if too_large := why_too_large(len(content), expanded):
            raise ValueError(too_large)
        with np.load(io.BytesIO(content), allow_pickle=False) as arrays:
            found = {field.name: arrays[field.name] for field in fields(Cloud)}
            return Cloud(**{**found, "unit": str(found["unit"])})
    except UNREADABLE as error:
        raise StoreError(
            f"{where} is damaged ({error}); remove it and reconstruct again"
        ) from error
