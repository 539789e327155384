"""Features and references in files: arrays of numpy, zipped, whole or not there at all."""

from __future__ import annotations

import io
import zipfile
import zlib
from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aerocues.methods.arrays import Keypoints
from aerocues.results.whole_files import write_whole

Arrays = Mapping[str, NDArray[Any]]
KEYPOINTS = tuple(field.name for field in fields(Keypoints))
_BROKEN = (ValueError, KeyError, EOFError, zipfile.BadZipFile, zlib.error)


def read_arrays(file: Path, names: tuple[str, ...]) -> Arrays | None:
    """The named arrays of a file; None where there is none, or it is damaged."""
    if not file.is_file():
        return None
    try:
        with np.load(file, allow_pickle=False) as arrays:
            return {name: arrays[name] for name in names}
    except _BROKEN:
        return None


def write_arrays(file: Path, arrays: Arrays, *, compressed: bool = False) -> None:
    """Write a file of arrays; OSError where there is no room."""
    content = io.BytesIO()
    named: dict[str, Any] = dict(arrays)
    save = np.savez_compressed if compressed else np.savez
    save(content, **named)
    write_whole({file: content.getbuffer()})


def keypoint_arrays(keypoints: Keypoints) -> dict[str, NDArray[Any]]:
    """Keypoints as arrays to write."""
    return {name: getattr(keypoints, name) for name in KEYPOINTS}


def keypoints_of(arrays: Arrays) -> Keypoints:
    """Keypoints from arrays that were read."""
    return Keypoints(**{name: arrays[name] for name in KEYPOINTS})
