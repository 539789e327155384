"""Files of kapture, OpenSfM and OpenMVG, read by kapture, which is independent of them all."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from aerocues.exports.flight import Flight
from tests.exports.written_flight import written, xy_of
from tests.reconstruction.scenes import CAMERA

pytestmark = pytest.mark.slow


def reconstruction_of(flight: Flight) -> list[dict[str, Any]]:
    """What the reader of kapture wants besides: shots, as OpenSfM writes them."""
    camera = {"projection_type": "perspective", "width": 480, "height": 360, "focal": 0.875}
    shot = {"camera": "one", "rotation": [0, 0, 0], "translation": [0, 0, 0]}
    return [{"cameras": {"one": camera}, "shots": dict.fromkeys(flight.images, shot)}]


@pytest.mark.filterwarnings("ignore:numpy.core")
def test_kapture_reads_what_is_for_opensfm(flight: Flight, tmp_path: Path) -> None:
    reader = pytest.importorskip("kapture.converter.opensfm.import_opensfm")
    features = pytest.importorskip("kapture.io.features")
    written(flight, "opensfm", tmp_path / "out")
    listed = json.dumps(reconstruction_of(flight))
    (tmp_path / "out" / "reconstruction.json").write_text(listed)
    reader.import_opensfm(str(tmp_path / "out"), str(tmp_path / "read"), True)
    for name in flight.images:
        path = tmp_path / "read/reconstruction/keypoints/HessianAffine" / f"{name}.kpt"
        rows = features.image_keypoints_from_file(str(path), np.float32, 4)
        assert len(rows) == len(xy_of(flight, name))
    matches = tmp_path / "read/reconstruction/matches/HessianAffine"
    for (first, second), indices in flight.verified.items():
        path = matches / f"{first}.overlapping" / f"{second}.matches"
        rows = features.image_matches_from_file(str(path))
        np.testing.assert_array_equal(rows[:, :2], indices)


def test_kapture_reads_what_is_for_openmvg(
    flight: Flight, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    reader = pytest.importorskip("kapture.converter.openmvg.import_openmvg")
    kapture = pytest.importorskip("kapture.io.csv")
    features = pytest.importorskip("kapture.io.features")
    actions = pytest.importorskip("kapture.io.records")
    if flight.combination.descriptor != "SIFT":
        pytest.skip("kapture reads OpenMVG's regions of SIFT only")
    monkeypatch.setattr(np, "float", float, raising=False)  # kapture is older than NumPy 1.24
    written(flight, "openmvg", tmp_path / "out")
    place = tmp_path / "out" / "matches"
    reader.import_openmvg(
        str(tmp_path / "out" / "sfm_data.json"),
        str(place),
        str(place / "matches.f.txt"),
        str(tmp_path / "read"),
        actions.TransferAction.copy,
        True,
    )
    found = kapture.kapture_from_dir(str(tmp_path / "read"))
    records = [name for _, _, name in _records(found)]
    assert [Path(name).name for name in records] == flight.images
    [kind] = found.keypoints
    for name, record in zip(flight.images, records, strict=True):
        path = features.get_keypoints_fullpath(kind, str(tmp_path / "read"), record)
        rows = features.image_keypoints_from_file(path, np.float64, 4)
        np.testing.assert_array_equal(rows[:, :2].astype(np.float32), xy_of(flight, name))
    assert len(found.matches[kind]) == len(flight.verified)


def _records(found: Any) -> list[tuple[int, str, str]]:
    import kapture

    return list(kapture.flatten(found.records_camera, is_sorted=True))


def test_kapture_reads_its_own(flight: Flight, tmp_path: Path) -> None:
    reader = pytest.importorskip("kapture.io.csv")
    features = pytest.importorskip("kapture.io.features")
    written(flight, "kapture", tmp_path / "out")
    root = str(tmp_path / "out")
    found = reader.kapture_from_dir(root)
    assert [name for _, _, name in _records(found)] == flight.images
    [camera] = found.cameras.values()
    assert camera.camera_params == [480, 360, CAMERA.focal_x, CAMERA.focal_y, 240, 180]
    [kind] = found.keypoints
    described, keypoints = found.descriptors[kind], found.keypoints[kind]
    assert described.keypoints_type == kind
    for name in flight.images:
        path = features.get_keypoints_fullpath(kind, root, name)
        rows = features.image_keypoints_from_file(path, keypoints.dtype, keypoints.dsize)
        np.testing.assert_array_equal(rows[:, :2], xy_of(flight, name) + np.float32(0.5))
        path = features.get_descriptors_fullpath(kind, root, name)
        descriptors = features.image_descriptors_from_file(path, described.dtype, described.dsize)
        np.testing.assert_array_equal(descriptors, flight.descriptors(name))
    assert len(found.matches[kind]) == len(flight.linked.pairs)
    for (first, second), matches in flight.linked.pairs.items():
        ordered = (first, second) if first < second else (second, first)
        path = features.get_matches_fullpath(ordered, kind, root)
        rows = features.image_matches_from_file(path)
        indices = matches.indices if first < second else matches.indices[:, ::-1]
        np.testing.assert_array_equal(rows[:, :2], indices)
        assert rows[:, 2].sum() == len(flight.verified[first, second])
