"""Features and matches of hloc, the hierarchical localisation toolbox: HDF5 files and pairs."""

from __future__ import annotations

import json
import shlex
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aerocues.exports.flight import Flight
from aerocues.methods.arrays import Int32Array

FEATURES, MATCHES, PAIRS = "feats.h5", "matches.h5", "pairs.txt"
VERIFIED = 0.5
"""Scores of matches that agree with the geometry are 1, above this; those of others are 0."""
RUN = (
    "from pathlib import Path; from hloc import reconstruction; d = Path({folder}); "
    'reconstruction.main(d / "sfm", d / "images", d / "pairs.txt", d / "feats.h5", '
    'd / "matches.h5", min_match_score={least})'
)


def write_hloc(flight: Flight, folder: Path) -> list[str]:
    """Write ``images/``, ``feats.h5``, ``matches.h5`` and ``pairs.txt``.

    As in hloc, the centre of the top-left pixel is (0, 0), and descriptors stand in columns.
    """
    import h5py

    with h5py.File(folder / FEATURES, "w", libver="latest") as file:
        for name in flight.images:
            _write_features(file.create_group(name), flight, name)
    with h5py.File(folder / MATCHES, "w", libver="latest") as file:
        for names, matches in flight.linked.pairs.items():
            group = file.create_group("/".join(name.replace("/", "-") for name in names))
            count = len(flight.linked.keypoints[names[0]])
            partners = _partners(matches.indices, count)
            agreeing = flight.verified.get(names, np.empty((0, 2), np.int32))
            scores = np.zeros(count, np.float16)
            scores[agreeing[:, 0]] = 1
            group.create_dataset("matches0", data=partners)
            group.create_dataset("matching_scores0", data=scores)
    pairs = "".join(f"{first} {second}\n" for first, second in flight.linked.pairs)
    (folder / PAIRS).write_text(pairs, encoding="utf-8")
    flight.move_images(folder)
    run = RUN.format(folder=json.dumps(str(folder)), least=VERIFIED)
    return [shlex.join(["python", "-c", run])]


def _write_features(group: Any, flight: Flight, name: str) -> None:
    keypoints, size = flight.linked.keypoints[name], flight.sizes[name]
    group.create_dataset("keypoints", data=keypoints.xy)
    group.create_dataset("descriptors", data=flight.descriptors(name).T)
    group.create_dataset("scores", data=np.ones(len(keypoints), np.float32))
    group.create_dataset("image_size", data=np.array([size.width, size.height]))
    group["keypoints"].attrs["uncertainty"] = 1.0


def _partners(indices: Int32Array, count: int) -> NDArray[np.int32]:
    """For each keypoint of the first image its match in the second; -1 without one."""
    partners = np.full(count, -1, np.int32)
    partners[indices[:, 0]] = indices[:, 1]
    return partners
