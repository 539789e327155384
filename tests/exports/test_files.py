"""Files of COLMAP, hloc, OpenSfM and ODM, read back.

Readers of COLMAP (pycolmap) and hloc (h5py, as hloc reads) are their own. OpenSfM, ODM, OpenMVG and
Bundler cannot be installed as packages of Python: their files are read as their source reads them.
"""

from __future__ import annotations

import gzip
import io
import json
import pickle
import pickletools
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

import aerocues
from aerocues.exports.flight import Flight
from tests.exports.written_flight import KEYPOINTS, written, xy_of
from tests.reconstruction.scenes import CAMERA

pytestmark = pytest.mark.slow


def test_the_flight_is_what_we_find_in_single_images(flight: Flight) -> None:
    pipeline = aerocues.Pipeline(flight.combination, max_keypoints=KEYPOINTS)
    found = {image.name: pipeline.features(image) for image in flight.scene.dataset.images}
    for name, features in found.items():
        np.testing.assert_array_equal(xy_of(flight, name), features.keypoints.xy)
        np.testing.assert_array_equal(flight.descriptors(name), features.descriptors)
    assert len(flight.linked.pairs) >= 3
    assert set(flight.verified) <= set(flight.linked.pairs)
    for (first, second), matches in flight.linked.pairs.items():
        # Our matches that agree with the geometry of the pair; COLMAP verifies most of them.
        ours = {tuple(row) for row in pipeline.match(found[first], found[second]).indices.tolist()}
        agreeing = {tuple(row) for row in matches.indices.tolist()}
        verified = {tuple(row) for row in flight.verified[first, second].tolist()}
        assert verified <= agreeing < ours
        assert len(verified) >= max(15, 0.8 * len(agreeing))


def test_colmap_opens_its_database(flight: Flight, tmp_path: Path) -> None:
    pycolmap = pytest.importorskip("pycolmap")
    [command] = written(flight, "colmap", tmp_path / "out")
    assert str(tmp_path / "out" / "database.db") in command
    database = pycolmap.Database.open(tmp_path / "out" / "database.db")
    numbers = {image.name: image.image_id for image in database.read_all_images()}
    assert set(numbers) == set(flight.images)
    [camera] = database.read_all_cameras()
    assert camera.params.tolist() == [CAMERA.focal_x, CAMERA.focal_y, 240.0, 180.0]
    for name in flight.images:
        rows = np.asarray(database.read_keypoints(numbers[name]))
        expected = xy_of(flight, name) + np.float32(0.5)
        np.testing.assert_array_equal(rows[:, :2], expected)
    for (first, second), matches in flight.linked.pairs.items():
        found = database.read_matches(numbers[first], numbers[second])
        np.testing.assert_array_equal(found, matches.indices)
        geometry = database.read_two_view_geometry(numbers[first], numbers[second])
        np.testing.assert_array_equal(geometry.inlier_matches, flight.verified[first, second])
    database.close()


def test_hloc_reads_features_and_matches(flight: Flight, tmp_path: Path) -> None:
    h5py = pytest.importorskip("h5py")
    [command] = written(flight, "hloc", tmp_path / "out")
    assert "min_match_score=0.5" in command
    pairs = [line.split() for line in (tmp_path / "out" / "pairs.txt").read_text().splitlines()]
    assert [tuple(pair) for pair in pairs] == list(flight.linked.pairs)
    with h5py.File(tmp_path / "out" / "feats.h5", "r", libver="latest") as file:
        for name in flight.images:
            np.testing.assert_array_equal(file[name]["keypoints"][()], xy_of(flight, name))
            descriptors = file[name]["descriptors"][()]
            np.testing.assert_array_equal(descriptors.T, flight.descriptors(name))
            assert file[name]["image_size"][()].tolist() == [CAMERA.width, CAMERA.height]
    with h5py.File(tmp_path / "out" / "matches.h5", "r", libver="latest") as file:
        for first, second in pairs:
            group = file[first][second]
            partners, scores = group["matches0"][()], group["matching_scores0"][()]
            indices = np.flatnonzero(partners != -1)
            found = np.stack([indices, partners[indices]], axis=-1)
            expected = flight.linked.pairs[first, second].indices
            np.testing.assert_array_equal(found, expected[np.argsort(expected[:, 0])])
            kept = found[scores[indices] > 0.5]
            verified = flight.verified[first, second]
            np.testing.assert_array_equal(kept, verified[np.argsort(verified[:, 0])])


# Names that OpenSfM's unpickler allows, in all versions of NumPy that it runs with.
ALLOWED = {"numpy.core.multiarray _reconstruct", "numpy ndarray", "numpy dtype"}


def read_opensfm_matches(file: Path) -> dict[str, NDArray[np.int32]]:
    content = gzip.decompress(file.read_bytes())
    names = {argument for code, argument, _ in pickletools.genops(content) if code.name == "GLOBAL"}
    assert names - {"_codecs encode"} <= ALLOWED
    found: dict[str, NDArray[np.int32]] = pickle.load(io.BytesIO(content))
    return found


@pytest.mark.parametrize(("target", "part"), [("opensfm", ""), ("odm", "opensfm")])
@pytest.mark.filterwarnings("ignore:numpy.core")
def test_opensfm_and_odm_find_features_and_matches(
    flight: Flight, tmp_path: Path, target: str, part: str
) -> None:
    commands = written(flight, target, tmp_path / "out")
    assert all("out" in command for command in commands)
    place = tmp_path / "out" / part
    width, height = CAMERA.width, CAMERA.height
    for name in flight.images:
        stored = np.load(place / "features" / f"{name}.features.npz", allow_pickle=False)
        assert stored["OPENSFM_FEATURES_VERSION"] == 1
        # As `denormalized_image_coordinates` of OpenSfM.
        pixels = stored["points"][:, :2] * width - 0.5 + np.array([width, height]) / 2
        np.testing.assert_allclose(pixels, xy_of(flight, name), atol=1e-4)
        np.testing.assert_array_equal(stored["descriptors"], flight.descriptors(name))
        keypoints = flight.linked.keypoints[name]
        np.testing.assert_allclose(stored["points"][:, 2] * width, keypoints.size, rtol=1e-5)
        np.testing.assert_array_equal(stored["points"][:, 3], keypoints.angle)
        picture = cv2.imread(str(tmp_path / "out" / "images" / name))
        assert picture is not None
        x, y = np.floor(keypoints.xy[0] + 0.5).astype(int)
        assert stored["colors"][0].tolist() == picture[y, x, ::-1].tolist()
    found: dict[tuple[str, str], NDArray[np.int32]] = {}
    for first in flight.images:
        matches = read_opensfm_matches(place / "matches" / f"{first}_matches.pkl.gz")
        found |= {(first, second): indices for second, indices in matches.items()}
    assert found.keys() == flight.verified.keys()
    for names, indices in found.items():
        np.testing.assert_array_equal(indices, flight.verified[names])
    camera = json.loads((place / "camera_models_overrides.json").read_text())["all"]
    assert camera["focal"] * width == pytest.approx(CAMERA.focal_x)
