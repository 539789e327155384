"""Features and verified matches of OpenSfM, and of ODM, which builds on it."""

from __future__ import annotations

import gzip
import io
import pickle
import shlex
from collections import defaultdict
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.header import read_header
from aerocues.exports.flight import Flight, flat
from aerocues.results.whole_files import json_content

FEATURES_VERSION = 1
"""The oldest that tells sizes of keypoints; all versions of OpenSfM and ODM read it."""
KNOWN = ("truth", "given")
"""Sources of focal lengths that EXIF data do not tell."""


def write_opensfm(flight: Flight, folder: Path) -> list[str]:
    """Write ``images/``, ``features/`` and ``matches/``: extracting and matching are done."""
    flight.copy_originals(folder)
    _write(flight, folder)
    (folder / "config.yaml").write_text(f"feature_type: {_kind(flight)}\n", encoding="utf-8")
    steps = ("extract_metadata", "create_tracks", "reconstruct", "undistort", "compute_depthmaps")
    return [shlex.join(["opensfm", step, str(folder)]) for step in steps]


def write_odm(flight: Flight, folder: Path) -> list[str]:
    """Write an ODM project whose features and matches are there: ODM goes on from them."""
    flight.copy_originals(folder)
    place = folder / "opensfm"
    place.mkdir(exist_ok=True)
    _write(flight, place)
    whole = folder.resolve()
    words = ["docker", "run", "--rm", "-v", f"{whole.parent}:/datasets", "opendronemap/odm"]
    return [shlex.join([*words, "--project-path", "/datasets", whole.name])]


def _kind(flight: Flight) -> str:
    """A type of OpenSfM whose descriptors have the same elements."""
    return "ORB" if flight.descriptor.bit_string else "SIFT"


def _write(flight: Flight, folder: Path) -> None:
    for name in ("features", "matches"):
        (folder / name).mkdir(exist_ok=True)
    for name in flight.images:
        _write_features(flight, name, folder / "features" / f"{flat(name)}.features.npz")
    matches: defaultdict[str, dict[str, NDArray[np.int32]]] = defaultdict(dict)
    for (first, second), indices in flight.verified.items():
        matches[first][flat(second)] = indices
    for name in flight.images:
        file = folder / "matches" / f"{flat(name)}_matches.pkl.gz"
        file.write_bytes(gzip.compress(_pickled(matches[name]), mtime=0))
    _write_camera(flight, folder)


def _write_features(flight: Flight, name: str, file: Path) -> None:
    """Positions from the centre of the image, in parts of its longer side; size; degrees."""
    keypoints, size = flight.linked.keypoints[name], flight.sizes[name]
    original = flight.original(name)
    width, height = (
        (size.width, size.height) if original is None else read_header(original, str(original)).size
    )
    longer = max(width, height)
    scale = np.array([width / size.width, height / size.height])
    pixels = (keypoints.xy.astype(np.float64) + 0.5) * scale
    places = (pixels - np.array([width, height]) / 2) / longer
    diameters = keypoints.size * scale.mean() / longer
    content = io.BytesIO()
    np.savez_compressed(
        content,
        points=np.column_stack([places, diameters, keypoints.angle]).astype(np.float32),
        descriptors=flight.descriptors(name),
        colors=_colours(flight, name),
        OPENSFM_FEATURES_VERSION=FEATURES_VERSION,
    )
    file.write_bytes(content.getbuffer())


def _colours(flight: Flight, name: str) -> NDArray[np.uint8]:
    """Red, green and blue of the pixel that each keypoint lies on, (N, 3)."""
    bgr = flight.scene.dataset.image(name).read().bgr
    limit = np.array(bgr.shape[1::-1]) - 1
    xy = np.floor(flight.linked.keypoints[name].xy + 0.5).astype(np.intp)
    columns, rows = np.clip(xy, 0, limit).T
    return bgr[rows, columns, ::-1]


def _pickled(matches: dict[str, NDArray[np.int32]]) -> bytes:
    """Matches by the name of the second image, as NumPy 1 and 2 read them."""
    content = pickle.dumps(matches, protocol=2)
    return content.replace(b"cnumpy._core.multiarray\n", b"cnumpy.core.multiarray\n")


def _write_camera(flight: Flight, folder: Path) -> None:
    """The camera where it is known and EXIF data do not tell it, and all images have the same."""
    [group, *others] = flight.scene.cameras
    if others or group.source not in KNOWN:
        return
    size = flight.sizes[group.names[0]]
    camera: dict[str, Any] = {
        "projection_type": "perspective",
        "width": size.width,
        "height": size.height,
        "focal": group.parameters[0] / max(size.width, size.height),
        "k1": 0.0,
        "k2": 0.0,
    }
    (folder / "camera_models_overrides.json").write_bytes(json_content({"all": camera}))
