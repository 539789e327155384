"""Files of other tools, read back: by the tool's own reader where one installs, else by its format.

Readers of COLMAP (pycolmap), hloc (h5py, as hloc reads) and kapture, which also reads OpenSfM and
OpenMVG, are their own. OpenSfM, ODM, OpenMVG and Bundler cannot be installed as packages of
Python: their files are read here as their source reads them.
"""

from __future__ import annotations

import gzip
import io
import json
import pickle
import pickletools
import shutil
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

import aerocues
from aerocues.datasets.dataset import Dataset
from aerocues.exports.flight import Flight, linked_flight
from aerocues.exports.match_lists import match_list
from aerocues.exports.targets import target_named
from aerocues.reconstruction.options import ReconstructionOptions
from aerocues.reconstruction.protocol import ReconstructionProtocol
from tests.made_once import made_once
from tests.reconstruction.scenes import CAMERA, write_scene

pytestmark = pytest.mark.slow
KEYPOINTS = 400


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    """Four photographs, each paired with each."""
    whole = made_once(tmp_path_factory, "landscape", write_scene)[1]
    kept = whole.images[:4]
    names = {image.name for image in kept}
    pairs = [pair for pair in whole.pairs if {pair.image_1, pair.image_2} <= names]
    return replace(whole, images=kept, pairs=pairs)


@pytest.fixture(scope="module", params=["SIFT-SIFT-L2-BF", "ORB-BRISK-HAM-BF"])
def flight(
    scene: Dataset, request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> Flight:
    """The scene under a combination with numbers, and under one with bits."""
    options = ReconstructionOptions(
        protocol=ReconstructionProtocol(0, KEYPOINTS, "refine"), refine_keypoints=False, workers=1
    )
    name = f"flight-{request.param}"
    make = partial(linked_flight, scene, request.param, options=options)
    return made_once(tmp_path_factory, name, make)[1]


def written(flight: Flight, target: str, folder: Path) -> list[str]:
    """Write the files of a target from a copy of the flight; the next commands."""
    work = folder.with_name("work")
    shutil.copytree(flight.scene.folder, work)
    scene = replace(flight.scene, folder=work, features=work / "features")
    folder.mkdir()
    commands: list[str] = target_named(target).load()(replace(flight, scene=scene), folder)
    for name in ("images", "sensors/records_data"):
        place = folder / name
        if place.is_dir():
            assert {path.name for path in place.iterdir()} == set(flight.images)
    return commands


def xy_of(flight: Flight, name: str) -> NDArray[np.float32]:
    return flight.linked.keypoints[name].xy


def test_the_flight_is_what_we_find_in_single_images(flight: Flight) -> None:
    pipeline = aerocues.Pipeline(flight.combination, max_keypoints=KEYPOINTS)
    found = {image.name: pipeline.features(image) for image in flight.scene.dataset.images}
    for name, features in found.items():
        np.testing.assert_array_equal(xy_of(flight, name), features.keypoints.xy)
        np.testing.assert_array_equal(flight.descriptors(name), features.descriptors)
    assert len(flight.linked.pairs) >= 3
    assert set(flight.verified) <= set(flight.linked.pairs)
    for (first, second), matches in flight.linked.pairs.items():
        expected = pipeline.match(found[first], found[second])
        np.testing.assert_array_equal(matches.indices, expected.indices)
        together = {tuple(row) for row in matches.indices.tolist()}
        verified = flight.verified[first, second]
        assert len(verified) >= 15
        assert {tuple(row) for row in verified.tolist()} <= together


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


def read_match_list(file: Path) -> dict[tuple[int, int], list[list[int]]]:
    """As OpenMVG and Bundler read it."""
    words = iter(file.read_text().split())
    found = {}
    for word in words:
        pair = int(word), int(next(words))
        count = int(next(words))
        found[pair] = [[int(next(words)), int(next(words))] for _ in range(count)]
    return found


def check_match_list(flight: Flight, file: Path, matches: dict[Any, NDArray[np.int32]]) -> None:
    found = read_match_list(file)
    assert len(found) == len(matches)
    for (one, two), rows in found.items():
        assert one < two
        names = flight.images[one], flight.images[two]
        expected = matches.get(names)
        if expected is None:
            expected = matches[names[1], names[0]][:, ::-1]
        assert rows == expected.tolist()


def test_openmvg_finds_regions_and_matches(flight: Flight, tmp_path: Path) -> None:
    [command] = written(flight, "openmvg", tmp_path / "out")
    place = tmp_path / "out" / "matches"
    assert str(place / "matches.f.txt") in command
    views = json.loads((tmp_path / "out" / "sfm_data.json").read_text())
    data = [view["value"]["ptr_wrapper"]["data"] for view in views["views"]]
    assert [each["filename"] for each in data] == flight.images
    [camera] = views["intrinsics"]
    inner = camera["value"]["ptr_wrapper"]["data"]
    assert inner["focal_length"] == CAMERA.focal_x
    assert inner["principal_point"] == [CAMERA.centre_x, CAMERA.centre_y]
    for name in flight.images:
        rows = np.loadtxt(place / f"{Path(name).stem}.feat", np.float32, ndmin=2)
        np.testing.assert_array_equal(rows[:, :2], xy_of(flight, name))
        content = (place / f"{Path(name).stem}.desc").read_bytes()
        assert int.from_bytes(content[:8], "little") == len(rows)
        length = 128 if flight.combination.descriptor == "SIFT" else 64
        descriptors = np.frombuffer(content[8:], np.uint8).reshape(len(rows), length)
        np.testing.assert_array_equal(descriptors, flight.descriptors(name))
    putative = {names: each.indices for names, each in flight.linked.pairs.items()}
    check_match_list(flight, place / "matches.putative.txt", putative)
    check_match_list(flight, place / "matches.f.txt", dict(flight.verified))


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


def test_bundler_finds_keys_and_matches(flight: Flight, tmp_path: Path) -> None:
    [command] = written(flight, "bundler", tmp_path / "out")
    assert command.startswith(f"cd {tmp_path / 'out'}")
    lines = (tmp_path / "out" / "list.txt").read_text().splitlines()
    assert [line.split() for line in lines] == [[name, "0", "420"] for name in flight.images]
    for name in flight.images:
        file = (tmp_path / "out" / name).with_suffix(".key.gz")
        words = gzip.decompress(file.read_bytes()).split()
        count, length = int(words[0]), int(words[1])
        assert (count, length) == (len(xy_of(flight, name)), 128)
        rows = np.array(words[2:], np.float64).reshape(count, 4 + length)
        np.testing.assert_array_equal(rows[:, 1::-1].astype(np.float32), xy_of(flight, name))
        if flight.combination.descriptor == "SIFT":
            np.testing.assert_array_equal(rows[:, 4:], flight.descriptors(name))
    check_match_list(flight, tmp_path / "out" / "matches.init.txt", dict(flight.verified))


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


def test_lists_of_matches_begin_with_the_lower_number() -> None:
    matches = {("b", "a"): np.array([[1, 2], [3, 4]], np.int32)}
    assert match_list(["a", "b"], matches) == "0 1\n2\n2 1\n4 3\n"
