"""Opening and preparing a scene: pairs, images as they are read, cameras, results that fit."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import polars as pl
import pytest
from PIL import Image as PillowImage

from aerocues.datasets.catalog import open_dataset
from aerocues.datasets.dataset import Dataset, Image
from aerocues.datasets.decoding import FileSource
from aerocues.errors import ReconstructionError, StoreError
from aerocues.reconstruction.focal_lengths import (
    exif_focal_length,
    told_taken,
    with_those_of_others,
)
from aerocues.reconstruction.images import (
    cameras_of,
    prepare_image,
    require_focal_lengths,
)
from aerocues.reconstruction.opening import open_scene
from aerocues.reconstruction.prepared import Prepared, read_prepared, write_prepared
from aerocues.reconstruction.protocol import ReconstructionProtocol
from aerocues.reconstruction.reconstruct import open_results
from aerocues.results.combination_columns import METHODS
from aerocues.results.store import Store
from tests.reconstruction.scenes import write_scene
from tests.reconstruction.test_clouds import cloud, square


def photograph(path: Path, *, latitude: float | None = None, film: int | None = 24) -> Path:
    """A JPEG file with EXIF data, 120 x 80."""
    path.parent.mkdir(parents=True, exist_ok=True)
    exif = PillowImage.Exif()
    if film:
        exif[0x8769] = {0xA405: film}
    if latitude:
        place = {1: "N", 2: (int(latitude), 60 * (latitude % 1), 0.0), 3: "E", 4: (35.0, 19.0, 0.0)}
        exif[0x8825] = place
    pixels = np.random.default_rng(0).integers(0, 255, (80, 120, 3), dtype=np.uint8)
    PillowImage.fromarray(pixels).save(path, exif=exif.tobytes())
    return path


def settings_of(dataset: Dataset) -> str:
    return dict(dataset.settings)["pairs"]


def test_pairs_are_neighbours_by_gps_else_all(tmp_path: Path) -> None:
    for number in range(4):
        photograph(tmp_path / "gps" / f"{number}.jpg", latitude=37.05 + number / 5000)
        photograph(tmp_path / "plain" / f"{number}.jpg")
    assert settings_of(open_scene(str(tmp_path / "gps"))) == "gps"
    assert settings_of(open_scene(str(tmp_path / "plain"))) == "exhaustive"
    assert len(open_scene(str(tmp_path / "plain")).pairs) == 6
    assert settings_of(open_scene(str(tmp_path / "gps"), pairs="consecutive")) == "consecutive"
    assert open_scene("synthetic", max_width=200).geometry == "homography"


def test_images_are_copied_as_they_are_or_written_as_they_are_read(tmp_path: Path) -> None:
    path = photograph(tmp_path / "photos" / "a.jpg")
    found = prepare_image(Image("inner/a.jpg", FileSource(path)), tmp_path / "images")
    assert (found.name, found.width, found.height) == ("inner/a.jpg", 120, 80)
    assert found.focal_length == pytest.approx(24 / 36 * 120, rel=0.05)
    assert (tmp_path / "images/inner/a.jpg").read_bytes() == path.read_bytes()
    shrunk = prepare_image(Image("b.jpg", FileSource(path, max_width=60)), tmp_path / "images")
    assert (shrunk.width, shrunk.height) == (60, 40)
    assert shrunk.focal_length == pytest.approx((found.focal_length or 0) / 2)
    with PillowImage.open(tmp_path / "images" / "b.jpg") as image:
        assert image.size == (60, 40)


def test_images_of_one_size_and_focal_length_share_a_camera(tmp_path: Path) -> None:
    dataset = write_scene(tmp_path, [(0, 0), (9, 0), (0, 9)], truth=False)
    sizes = [(480, 360, 400.0), (480, 360, 400.0), (360, 480, 400.0)]
    names = [image.name for image in dataset.images]
    prepared = [Prepared(name, *size) for name, size in zip(names, sizes, strict=True)]
    wide, high = cameras_of(dataset, prepared, ReconstructionProtocol())
    assert (wide.names, high.names) == (tuple(names[:2]), (names[2],))
    assert wide.parameters == (400.0, 240.0, 180.0, 0.0)
    [given, _] = cameras_of(dataset, prepared, ReconstructionProtocol(focal_length=500.0))
    assert (given.parameters[0], given.source) == (500.0, "given")


def test_a_focal_length_that_is_not_known_may_be_refined_only(tmp_path: Path) -> None:
    dataset = write_scene(tmp_path, [(0, 0), (9, 0)], truth=False)
    prepared = [Prepared(image.name, 480, 360, None) for image in dataset.images]
    refined = ReconstructionProtocol(intrinsics="refine")
    [camera] = cameras_of(dataset, prepared, refined)
    assert (camera.parameters, camera.source) == ((), "guessed")
    require_focal_lengths([camera], refined)
    with pytest.raises(ReconstructionError, match=r"2 of 2 .* `focal_length` in pixels"):
        require_focal_lengths([camera], ReconstructionProtocol())


def test_an_image_takes_the_focal_length_of_the_others_of_its_camera() -> None:
    sizes = [(480, 360, 400.0), (360, 480, None), (480, 360, 400.4), (640, 360, None)]
    prepared = [Prepared(name, *size) for name, size in zip("abcd", sizes, strict=True)]
    found, names = with_those_of_others(prepared)
    assert (names, [each.focal_length for each in found]) == (["b"], [400.0, 400.0, 400.4, None])
    assert told_taken(names, found) == (
        "focal length: 1 of 4 images takes that of the others from EXIF (400.0 px): b"
    )
    two = [*prepared, Prepared("e", 480, 360, 700.0)]
    assert with_those_of_others(two) == (two, [])


@pytest.mark.parametrize("film", [0, 1, 65000])
def test_a_focal_length_that_cannot_be_right_is_not_known(tmp_path: Path, film: int) -> None:
    path = photograph(tmp_path / "a.jpg", film=film)
    assert exif_focal_length(FileSource(path), 120) is None


def test_a_focal_length_with_denominator_zero_is_not_known(shared_data: Path) -> None:
    folder = shared_data.parent / "cases" / "focal_denominator_zero" / "photos"
    found = {path.name: exif_focal_length(FileSource(path), 100) for path in folder.iterdir()}
    assert all(each is None or 20 < each < 5000 for each in found.values())


def test_prepared_images_are_remembered_until_they_change(tmp_path: Path) -> None:
    (tmp_path / "images").mkdir()
    for name in ("a.png", "b.png"):
        (tmp_path / "images" / name).touch()
    prepared = {name: Prepared(name, 4, 3, None) for name in ("a.png", "b.png")}
    assert read_prepared(tmp_path, {"a.png": "1"}) == {}
    write_prepared(tmp_path, {"a.png": "1", "b.png": "2"}, prepared)
    assert read_prepared(tmp_path, {"a.png": "1", "b.png": "2"}) == prepared
    assert list(read_prepared(tmp_path, {"a.png": "9", "b.png": "2"})) == ["b.png"]
    (tmp_path / "images" / "b.png").unlink()
    assert read_prepared(tmp_path, {"a.png": "9", "b.png": "2"}) == {}


def row(detector: str, key: str, dataset: str = "photos") -> dict[str, object]:
    values = dict(zip(METHODS, (detector, "SIFT", "L2", "BF"), strict=True))
    return {"dataset": dataset, **values, "status": "ok", "settings_key": key, "points_3d": 5}


def test_figures_of_other_settings_are_replaced(tmp_path: Path) -> None:
    store = Store.create(tmp_path / "results")
    store.add_reconstructions(pl.DataFrame([row("ORB", "1"), row("AKAZE", "1")]))
    store.add_reconstructions(pl.DataFrame([row("SIFT", "1"), row("ORB", "1")]))
    assert sorted(store.reconstructions()["detector"]) == ["AKAZE", "ORB", "SIFT"]
    store.add_reconstructions(pl.DataFrame([row("KAZE", "7", "other")]))
    store.add_reconstructions(pl.DataFrame([row("ORB", "2")]))
    found = store.reconstructions().select("dataset", "detector", "settings_key").rows()
    assert sorted(found) == [("other", "KAZE", "7"), ("photos", "ORB", "2")]


def test_clouds_go_with_their_rows(tmp_path: Path) -> None:
    store = Store.create(tmp_path / "results")
    for key in ("old", "kept"):
        store.write_cloud(key, cloud(square()))
    store.add_reconstructions(pl.DataFrame([{**row("ORB", "1"), "row_key": "kept"}]))
    assert [file.stem for file in store.cloud_files()] == ["kept"]


def test_clouds_lie_beside_the_figures(tmp_path: Path) -> None:
    store = Store.create(tmp_path / "results")
    assert store.cloud("key") is None
    store.write_cloud("key", cloud(square()))
    found = store.cloud("key")
    assert found is not None
    assert len(found.points) == 100
    assert [file.name for file in store.cloud_files()] == ["key.npz"]
    store.cloud_files()[0].write_bytes(b"half")
    with pytest.raises(StoreError, match=r"key\.npz"):
        store.cloud("key")


def test_results_of_other_images_are_refused(tmp_path: Path) -> None:
    import aerocues

    for name in ("one", "two"):
        for number in range(2):
            photograph(tmp_path / name / f"{number}.jpg")
    aerocues.run(str(tmp_path / "one"), "ORB-ORB-HAM-BF", tmp_path / "results")
    with pytest.raises(StoreError, match=r"\bone\b.*\btwo\b"):
        open_results(tmp_path / "results", open_dataset(str(tmp_path / "two")))
    assert open_results(tmp_path / "results", open_dataset(str(tmp_path / "one")))
