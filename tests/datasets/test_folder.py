from __future__ import annotations

import pickle
import shutil
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from PIL import Image as PillowImage

from aerocues.datasets.catalog import open_dataset
from aerocues.datasets.listing import natural_key
from aerocues.errors import DatasetError
from aerocues.evaluation.run import run
from tests.evaluation.inline import InlineEngine


def test_images_come_in_natural_order_and_nothing_else(image_folder: Path) -> None:
    dataset = open_dataset(str(image_folder))
    assert [image.name for image in dataset.images] == ["img1.JPG", "img2.png", "img10.png"]
    assert [(p.index, p.image_1, p.image_2, p.sequence) for p in dataset.pairs] == [
        (0, "img1.JPG", "img2.png", "scene"),
        (1, "img2.png", "img10.png", "scene"),
    ]
    assert (dataset.name, dataset.geometry) == ("scene", "epipolar")
    assert dict(dataset.settings) == {
        "pairs": "consecutive",
        "max_width": "full",
        "equalize": "none",
    }


def test_a_dataset_is_cheap_to_hold_and_pickles(image_folder: Path) -> None:
    dataset = open_dataset(str(image_folder), max_width=40)
    dataset.image("img2.png")
    copy = pickle.loads(pickle.dumps(dataset))
    assert len(pickle.dumps(dataset)) < 4_000
    assert np.array_equal(copy.image("img2.png").read().bgr, dataset.image("img2.png").read().bgr)
    with pytest.raises(KeyError):
        copy.image("img3.png")


@given(number=st.integers(0, 10**12), next_number=st.integers(0, 10**12))
def test_numbers_in_names_count_as_numbers(number: int, next_number: int) -> None:
    keys = natural_key(f"DJI_{number}.jpg"), natural_key(f"DJI_{next_number}.jpg")
    assert (keys[0] < keys[1]) == (number < next_number)


@given(names=st.lists(st.text(max_size=6)))
@example(names=["a²", "a2", "²", "٣", ""])
def test_any_names_have_an_order(names: list[str]) -> None:
    backwards = list(reversed(names))
    assert sorted(backwards, key=natural_key) == sorted(names, key=natural_key)


def test_too_few_images(tmp_path: Path, image_folder: Path) -> None:
    empty = tmp_path / "empty"
    empty.mkdir()
    with pytest.raises(DatasetError, match="empty"):
        open_dataset(str(empty))
    (image_folder / "img2.png").unlink()
    (image_folder / "img10.png").unlink()
    with pytest.raises(DatasetError, match=r"img1\.JPG"):
        open_dataset(str(image_folder))


def test_a_folder_of_folders_is_told_how_to_open(tmp_path: Path, image_folder: Path) -> None:
    with pytest.raises(DatasetError, match=r"scene.*uav:.*flight:"):
        open_dataset(str(tmp_path))


def test_a_flight_may_be_a_tree(tmp_path: Path, image_folder: Path) -> None:
    trip = tmp_path / "trip"
    for folder in ("100MEDIA", "99MEDIA"):
        shutil.copytree(image_folder, trip / folder)
    dataset = open_dataset(f"flight:{trip}")
    assert [image.name for image in dataset.images][:4] == [
        "99MEDIA/img1.JPG",
        "99MEDIA/img2.png",
        "99MEDIA/img10.png",
        "100MEDIA/img1.JPG",
    ]
    assert len(dataset.pairs) == 5
    assert dataset.name == "trip"


def test_projects(tmp_path: Path, image_folder: Path) -> None:
    (tmp_path / "papers").mkdir()
    shutil.copytree(image_folder, tmp_path / "village")
    dataset = open_dataset(f"uav:{tmp_path}", pairs="exhaustive")
    assert [(p.index, p.sequence, p.image_1) for p in dataset.pairs][2:4] == [
        (2, "scene", "scene/img2.png"),
        (3, "village", "village/img1.JPG"),
    ]
    assert (dataset.name, len(dataset.images)) == ("uav", 6)
    (tmp_path / "lone").mkdir()
    shutil.copy(image_folder / "img2.png", tmp_path / "lone")
    with pytest.raises(DatasetError, match="lone"):
        open_dataset(f"uav:{tmp_path}")
    with pytest.raises(DatasetError, match=str(image_folder)):
        open_dataset(f"uav:{image_folder}")


def test_a_pairs_file_names_images_of_all_projects(tmp_path: Path, image_folder: Path) -> None:
    shutil.copytree(image_folder, tmp_path / "village")
    file = tmp_path / "pairs.txt"
    file.write_text(
        "village/img10.png village/img1.JPG\n"
        "scene/img1.JPG scene/img2.png\n"
        "village/img2.png scene/img2.png\n"
    )
    dataset = open_dataset(f"uav:{tmp_path}", pairs=str(file))
    assert [(p.index, p.sequence, p.image_1, p.image_2) for p in dataset.pairs] == [
        (0, "village", "village/img10.png", "village/img1.JPG"),
        (1, "scene", "scene/img1.JPG", "scene/img2.png"),
        (2, "village", "village/img2.png", "scene/img2.png"),
    ]
    file.write_text("village/img10.png village/img1.JPG\nvillage/img3.png village/img1.JPG\n")
    with pytest.raises(DatasetError, match=r"line 2: .*'village/img3\.png'"):
        open_dataset(f"uav:{tmp_path}", pairs=str(file))


def test_an_empty_file_is_an_error_of_its_own_pairs(tmp_path: Path, image_folder: Path) -> None:
    (image_folder / "img2.png").write_bytes(b"")
    dataset = open_dataset(str(image_folder), pairs="exhaustive", max_width=40)
    rows = run(
        dataset, "ORB-ORB-HAM-BF,ORB-LUCID-HAM-BF", tmp_path / "results", engine=InlineEngine()
    ).table()
    assert len(rows) == 6
    for row in rows.iter_rows(named=True):
        broken = "img2.png" in (row["image_1"], row["image_2"])
        assert (row["status"] == "error") == broken
        assert ("img2.png" in (row["message"] or "")) == broken


def test_gps_pairs_from_exif(tmp_path: Path) -> None:
    for number, minute in enumerate((0.0, 30.0, 0.01)):
        exif = PillowImage.Exif()
        exif[0x8825] = {1: "N", 2: (46.0, minute, 0.0), 3: "E", 4: (9.0, 0.0, 0.0)}
        PillowImage.new("RGB", (32, 32)).save(tmp_path / f"{number}.jpg", exif=exif)
    dataset = open_dataset(f"flight:{tmp_path}", pairs="gps:50m")
    assert [(p.image_1, p.image_2) for p in dataset.pairs] == [("0.jpg", "2.jpg")]
    assert [image.name for image in dataset.images] == ["0.jpg", "2.jpg"]


def test_a_pairs_file_chooses(tmp_path: Path, image_folder: Path) -> None:
    file = tmp_path / "pairs.txt"
    file.write_text("img10.png img1.JPG\n")
    dataset = open_dataset(str(image_folder), pairs=str(file))
    assert [(p.image_1, p.image_2) for p in dataset.pairs] == [("img10.png", "img1.JPG")]
    file.write_text("img10.png img3.png\n")
    with pytest.raises(DatasetError, match=r"line 1: .*'img3\.png'"):
        open_dataset(str(image_folder), pairs=str(file))


def test_real_flight_and_projects(shared_data: Path) -> None:
    flight = open_dataset(f"flight:{shared_data / 'flights' / 'brighton_beach'}")
    assert (len(flight.images), len(flight.pairs)) == (18, 17)
    assert all(image.gps is not None for image in flight.images)
    near = open_dataset(f"flight:{shared_data / 'flights' / 'brighton_beach'}", pairs="gps:4")
    assert len(near.pairs) > 30
    uav = open_dataset(f"uav:{shared_data / 'pairs'}")
    assert [p.sequence for p in uav.pairs] == [
        "boruszyn_kap",
        "brighton_beach",
        "garfield_rgb",
        "lewis",
        "seneca",
    ]
