"""Keys, matches and the list of images of Bundler."""

from __future__ import annotations

import gzip
import shlex
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from aerocues.exports.flight import Flight, flat
from aerocues.exports.match_lists import match_list
from aerocues.reconstruction.database import keypoint_rows

LIST, MATCHES, OPTIONS = "list.txt", "matches.init.txt", "options.txt"
LENGTH = 128
"""Elements of a descriptor, which Bundler insists on; it uses them for matching only."""
SETTINGS = (
    "--match_table matches.init.txt",
    "--output bundle.out",
    "--output_all bundle_",
    "--output_dir bundle",
    "--variable_focal_length",
    "--use_focal_estimate",
    "--constrain_focal",
    "--constrain_focal_weight 0.0001",
    "--estimate_distortion",
    "--ray_angle_threshold 2.0",
    "--run_bundle",
)
"""Those of Bundler's own script."""


def write_bundler(flight: Flight, folder: Path) -> list[str]:
    """Write images, ``.key.gz``, ``list.txt``, ``matches.init.txt`` and ``options.txt``.

    A key is a row and a column, with the centre of the top-left pixel at (0, 0), scale, and
    orientation. Descriptors of SIFT are written; zeros stand in place of others.
    """
    (folder / "bundle").mkdir(exist_ok=True)
    lines = []
    for name in flight.images:
        focal = flight.focal_length(name)
        image = flat(name)
        (flight.scene.images / name).replace(folder / image)
        lines.append(f"{image} 0 {focal:.9g}" if focal else image)
        rows = keypoint_rows(flight.linked.keypoints[name])
        text = _keys(rows, _descriptors(flight, name))
        key = (folder / image).with_suffix(".key.gz")
        key.write_bytes(gzip.compress(text.encode(), mtime=0))
    (folder / LIST).write_text("".join(f"{line}\n" for line in lines), encoding="utf-8")
    matches = match_list(flight.images, flight.verified)
    (folder / MATCHES).write_text(matches, encoding="utf-8")
    options = "".join(f"{line}\n" for line in SETTINGS)
    (folder / OPTIONS).write_text(options, encoding="utf-8")
    return [f"cd {shlex.quote(str(folder))} && bundler {LIST} --options_file {OPTIONS}"]


def _descriptors(flight: Flight, name: str) -> NDArray[np.uint8]:
    count = len(flight.linked.keypoints[name])
    if flight.descriptor.name == "SIFT":
        return flight.descriptors(name).astype(np.uint8)
    return np.zeros((count, LENGTH), np.uint8)


def _keys(rows: NDArray[np.float32], descriptors: NDArray[np.uint8]) -> str:
    lines = [f"{len(rows)} {LENGTH}"]
    for (x, y, scale, orientation), numbers in zip(
        rows.tolist(), descriptors.tolist(), strict=True
    ):
        lines.append(f"{y:.9g} {x:.9g} {scale:.9g} {orientation:.9g}")
        lines += [
            " " + " ".join(map(str, numbers[start : start + 20])) for start in range(0, LENGTH, 20)
        ]
    return "".join(f"{line}\n" for line in lines)
