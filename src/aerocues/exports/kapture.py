"""A flight in the format of kapture 1.1."""

from __future__ import annotations

import shlex
import shutil
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aerocues.exports.flight import Flight
from aerocues.reconstruction.database import keypoint_rows
from aerocues.reconstruction.images import HALF_PIXEL
from aerocues.reconstruction.scene import CameraGroup

HEADER = "# kapture format: 1.1"
NO_MATCHES = np.empty((0, 2), np.int32)


def write_kapture(flight: Flight, folder: Path) -> list[str]:
    """Write ``sensors/`` with the images, and ``reconstruction/`` with features and matches.

    As in COLMAP, whose cameras kapture has, the centre of the top-left pixel is (0.5, 0.5). The
    score of a match is 1 where it agrees with the geometry of its pair, else 0.
    """
    one = flight.combination
    kind = f"{one.detector}-{one.descriptor}"
    sensors, found = folder / "sensors", folder / "reconstruction"
    places = {part: found / part / kind for part in ("keypoints", "descriptors", "matches")}
    for place in (sensors, *places.values()):
        place.mkdir(parents=True, exist_ok=True)
    if (sensors / "records_data").exists():
        shutil.rmtree(sensors / "records_data")
    shutil.move(flight.scene.images, sensors / "records_data")
    _write_sensors(flight, sensors)
    row = flight.descriptor
    _write_table(
        places["keypoints"] / "keypoints.txt", "name, dtype, dsize", [f"{kind}, float32, 4"]
    )
    metric = "L2" if one.norm == "L2" else "Hamming"
    _write_table(
        places["descriptors"] / "descriptors.txt",
        "name, dtype, dsize, keypoints_type, metric_type",
        [f"{row.name}, {row.dtype}, {_length(flight)}, {kind}, {metric}"],
    )
    for name in flight.images:
        rows = keypoint_rows(flight.linked.keypoints[name])
        rows[:, :2] += np.float32(HALF_PIXEL)
        _write_array(places["keypoints"] / f"{name}.kpt", rows)
        _write_array(places["descriptors"] / f"{name}.desc", flight.descriptors(name))
    _write_matches(flight, places["matches"])
    database = folder.with_name(f"{folder.name}-colmap") / "database.db"
    words = ["kapture_export_colmap", "-k", str(folder), "-db", str(database)]
    return [shlex.join(words)]


def _length(flight: Flight) -> int:
    described = next(name for name in flight.images if len(flight.linked.keypoints[name]))
    return int(flight.descriptors(described).shape[1])


def _write_matches(flight: Flight, place: Path) -> None:
    """One file a pair, in the order of names: indices of both keypoints and the score."""
    for (first, second), matches in flight.linked.pairs.items():
        agreeing = {
            tuple(each) for each in flight.verified.get((first, second), np.empty((0, 2))).tolist()
        }
        scores = [float(tuple(each) in agreeing) for each in matches.indices.tolist()]
        one, two, indices = first, second, matches.indices
        if first > second:
            one, two, indices = second, first, indices[:, ::-1]
        rows = np.column_stack([indices, scores]).astype(np.float64).reshape(-1, 3)
        _write_array(place / f"{one}.overlapping" / f"{two}.matches", rows)


def _write_sensors(flight: Flight, folder: Path) -> None:
    cameras = list(flight.scene.cameras)
    listed = [
        f"camera{number}, , camera, {_model(group, flight)}" for number, group in enumerate(cameras)
    ]
    _write_table(folder / "sensors.txt", "sensor_device_id, name, sensor_type, [params]+", listed)
    records = [
        f"{number}, camera{cameras.index(flight.camera(name))}, {name}"
        for number, name in enumerate(flight.images)
    ]
    _write_table(folder / "records_camera.txt", "timestamp, device_id, image_path", records)


def _model(group: CameraGroup, flight: Flight) -> str:
    """Model, size and parameters, as COLMAP has them."""
    size = flight.sizes[group.names[0]]
    model = group.model if group.parameters else "UNKNOWN_CAMERA"
    values = (size.width, size.height, *group.parameters)
    return ", ".join([model, *(f"{value:.17g}" for value in values)])


def _write_table(file: Path, columns: str, rows: Iterable[str]) -> None:
    lines = [HEADER, f"# {columns}", *rows]
    file.write_text("".join(f"{line}\n" for line in lines), encoding="utf-8")


def _write_array(file: Path, array: NDArray[Any]) -> None:
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_bytes(np.ascontiguousarray(array).tobytes())
