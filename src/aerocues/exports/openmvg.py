"""Regions and matches of OpenMVG, with its list of views."""

from __future__ import annotations

import json
import shlex
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aerocues.errors import ReconstructionError
from aerocues.exports.flight import FOCAL_GUESS, Flight
from aerocues.exports.match_lists import match_list
from aerocues.reconstruction.database import keypoint_rows
from aerocues.reconstruction.images import HALF_PIXEL
from aerocues.reconstruction.scene import CameraGroup

VIEWS, MATCHES = "sfm_data.json", "matches"
PUTATIVE, GEOMETRIC = "matches.putative.txt", "matches.f.txt"
NEW, NOTHING = 1 << 31, 1 << 30  # marks of cereal, which OpenMVG writes JSON with
REGIONS = {
    "SIFT": ("SIFT_Regions", "SIFT_Image_describer", np.uint8, 128),
    "uint8": ("AKAZE_Binary_Regions", "AKAZE_Image_describer_MLDB", np.uint8, 64),
    "float32": ("AKAZE_Float_Regions", "AKAZE_Image_describer_SURF", np.float32, 64),
}
"""Types of OpenMVG, and the descriptors that they hold; shorter ones are filled up with zeros."""


def write_openmvg(flight: Flight, folder: Path) -> list[str]:
    """Write ``images/``, ``sfm_data.json`` and ``matches/`` with ``.feat`` and ``.desc``.

    Features and matches are those of the scene; the centre of the top-left pixel is (0, 0).
    """
    _check_names(flight)
    place = folder / MATCHES
    place.mkdir(exist_ok=True)
    flight.move_images(folder)
    (folder / VIEWS).write_text(json.dumps(_views(flight, folder), indent=1), encoding="utf-8")
    row = flight.descriptor
    regions, describer, dtype, length = REGIONS["SIFT" if row.name == "SIFT" else row.dtype]
    described = {
        "image_describer": _polymorphic(1, describer, {"params": {}}),
        "regions_type": _polymorphic(2, regions, {"value0": [], "value1": []}),
    }
    (place / "image_describer.json").write_text(json.dumps(described, indent=1), encoding="utf-8")
    for name in flight.images:
        stem = Path(name).stem
        rows = keypoint_rows(flight.linked.keypoints[name])
        np.savetxt(place / f"{stem}.feat", rows, "%.9g")
        descriptors = flight.descriptors(name)
        if descriptors.shape[1] <= length:
            content = _filled(descriptors.astype(dtype), length).tobytes()
            header = np.array([len(rows)], np.uint64).tobytes()
            (place / f"{stem}.desc").write_bytes(header + content)
    putative = {names: each.indices for names, each in flight.linked.pairs.items()}
    for file, matches in ((PUTATIVE, putative), (GEOMETRIC, flight.verified)):
        text = match_list(flight.images, matches)
        (place / file).write_text(text, encoding="utf-8")
    words = ["openMVG_main_SfM", "-i", str(folder / VIEWS), "-m", str(place)]
    words += ["-M", str(place / GEOMETRIC), "-o", str(folder / "sfm"), "-s", "INCREMENTAL"]
    return [shlex.join(words)]


def _check_names(flight: Flight) -> None:
    """OpenMVG calls files of features like images, without folder and suffix."""
    seen: dict[str, str] = {}
    for name in flight.images:
        other = seen.setdefault(Path(name).stem, name)
        if other != name:
            raise ReconstructionError(
                f"OpenMVG cannot tell {name} from {other}, as it leaves out folders and suffixes; "
                "rename one of them"
            )


def _filled(descriptors: NDArray[Any], length: int) -> NDArray[Any]:
    missing = length - descriptors.shape[1]
    return np.ascontiguousarray(np.pad(descriptors, ((0, 0), (0, missing))))


def _polymorphic(number: int, name: str, data: dict[str, Any]) -> dict[str, Any]:
    wrapped = {"valid": 1, "data": data}
    return {
        "polymorphic_id": NEW | number,
        "polymorphic_name": name,
        "ptr_wrapper": wrapped,
    }


def _views(flight: Flight, folder: Path) -> dict[str, Any]:
    cameras = list(flight.scene.cameras)
    views = []
    for number, name in enumerate(flight.images):
        size = flight.sizes[name]
        path = Path(name)
        data = {
            "local_path": "" if path.parent == Path() else str(path.parent),
            "filename": path.name,
            "width": size.width,
            "height": size.height,
            "id_view": number,
            "id_intrinsic": cameras.index(flight.camera(name)),
            "id_pose": number,
        }
        wrapped = {"id": NEW | (len(cameras) + number + 1), "data": data}
        views.append({"key": number, "value": {"polymorphic_id": NOTHING, "ptr_wrapper": wrapped}})
    return {
        "sfm_data_version": "0.3",
        "root_path": str((folder / "images").resolve()),
        "views": views,
        "intrinsics": _intrinsics(flight, cameras),
        "extrinsics": [],
        "structure": [],
        "control_points": [],
    }


def _intrinsics(flight: Flight, cameras: list[CameraGroup]) -> list[dict[str, Any]]:
    """Cameras with one coefficient of distortion; their centre follows that of the pixels."""
    found = []
    known: dict[str, Any] = {"polymorphic_id": NEW | 1, "polymorphic_name": "pinhole_radial_k1"}
    for number, group in enumerate(cameras):
        size = flight.sizes[group.names[0]]
        focal = flight.focal_length(group.names[0])
        centre = [size.width / 2 - HALF_PIXEL, size.height / 2 - HALF_PIXEL]
        if group.model == "PINHOLE":
            centre = [value - HALF_PIXEL for value in group.parameters[2:4]]
        data = {
            "width": size.width,
            "height": size.height,
            "focal_length": focal or FOCAL_GUESS * max(size.width, size.height),
            "principal_point": centre,
            "disto_k1": [group.parameters[3] if group.model == "SIMPLE_RADIAL" and focal else 0.0],
        }
        wrapped = {"id": NEW | (number + 1), "data": data}
        found.append({"key": number, "value": {**known, "ptr_wrapper": wrapped}})
        known = {"polymorphic_id": 1}
    return found
