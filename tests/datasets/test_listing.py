"""Which files are taken as images, what is left out, and what looks odd."""

from __future__ import annotations

import shutil
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np
import pytest
from PIL import Image as PillowImage

from aerocues.datasets import listing
from aerocues.datasets.catalog import open_dataset
from aerocues.datasets.listing import list_images
from aerocues.datasets.metadata import Metadata
from aerocues.datasets.oddities import oddities
from aerocues.errors import DatasetError

BEGIN = datetime(2026, 5, 1, 10)


def photo(path: Path, seed: int, size: tuple[int, int] = (40, 30)) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    pixels = np.random.default_rng(seed).integers(0, 256, (size[1], size[0], 3), dtype=np.uint8)
    PillowImage.fromarray(pixels).save(path)
    return path


@pytest.fixture
def flight(tmp_path: Path) -> Path:
    for number in range(3):
        photo(tmp_path / "flight" / f"{number}.jpg", number)
    return tmp_path / "flight"


def names(folder: Path) -> list[str]:
    return [image.name for image in open_dataset(f"flight:{folder}").images]


def test_a_clean_flight_needs_no_line(flight: Path) -> None:
    (flight / "flight.srt").write_text("subtitles")
    (flight / ".DS_Store").write_bytes(b"")
    assert open_dataset(f"flight:{flight}").notes == ()


@pytest.mark.parametrize(
    "thumbnail", ["@eaDir/0.jpg/SYNOPHOTO_THUMB_M.jpg", "MISC/THM/0.THM.jpg", "__MACOSX/0.jpg"]
)
def test_thumbnails_of_cameras_and_servers_are_left_out(flight: Path, thumbnail: str) -> None:
    photo(flight / thumbnail, 9)
    dataset = open_dataset(f"flight:{flight}")
    assert [image.name for image in dataset.images] == ["0.jpg", "1.jpg", "2.jpg"]
    [note] = dataset.notes
    assert note.startswith("3 images; left out: thumbnails (")
    assert names(photo(flight / "THM" / "a.jpg", 7).parent.parent)[-1] == "THM/a.jpg"


@pytest.mark.parametrize("mark", ["run.json", "reconstruction.json"])
def test_own_output_is_left_out(flight: Path, mark: str) -> None:
    photo(flight / "models" / "images" / "0.jpg", 0)
    photo(flight / "models" / "ORB-ORB-HAM-BF" / "picture.png", 1)
    (flight / "models" / mark).write_text("{}")
    dataset = open_dataset(f"flight:{flight}")
    assert dataset.notes == ("3 images; left out: output of aerocues (models)",)
    assert len(dataset.images) == 3


def test_own_output_may_lie_in_the_folder_itself(flight: Path) -> None:
    photo(flight / "images" / "0.jpg", 0)
    photo(flight / "ORB-ORB-HAM-BF" / "undistorted" / "images" / "0.jpg", 1)
    photo(flight / "100MEDIA" / "0.jpg", 5)
    (flight / "reconstruction.json").write_text("{}")
    assert names(flight) == ["0.jpg", "1.jpg", "2.jpg", "100MEDIA/0.jpg"]


def test_links_are_followed_once(flight: Path, tmp_path: Path) -> None:
    linked = tmp_path / "linked"
    linked.mkdir()
    (linked / "100MEDIA").symlink_to(flight)
    (linked / "again").symlink_to(flight)
    (linked / "loop").symlink_to(linked)
    (linked / "gone.jpg").symlink_to(tmp_path / "nothing.jpg")
    dataset = open_dataset(f"flight:{linked}")
    assert [image.name for image in dataset.images] == [f"100MEDIA/{n}.jpg" for n in range(3)]
    assert dataset.notes == (
        "3 images; left out: the same by a link (again, loop), broken links (gone.jpg)",
    )


def test_files_of_other_kinds_are_named_with_what_to_do(
    flight: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(listing, "can_read_heic", lambda: False)
    for name in ("a.HEIC", "b.heif", "a.DNG", "flight.MP4"):
        (flight / name).write_bytes(b"no image")
    (flight / "._0.jpg").write_bytes(b"")
    [note] = open_dataset(str(flight)).notes
    assert "2 HEIC files (a.HEIC, b.heif): install pillow-heif" in note
    assert "1 raw file (a.DNG): export" in note
    assert "1 video file (flight.MP4)" in note
    assert "1 hidden file" in note
    for path in flight.glob("*.jpg"):
        path.unlink()
    with pytest.raises(DatasetError, match=r"no images.*2 HEIC files \(a\.HEIC, b\.heif\)"):
        open_dataset(str(flight))


def test_what_looks_odd_is_told(flight: Path) -> None:
    shutil.copy(flight / "0.jpg", flight / "copy.jpg")
    photo(flight / "small.jpg", 7, (20, 15))
    photo(flight / "upright.jpg", 8, (30, 40))
    [note] = open_dataset(str(flight)).notes
    assert note == (
        "6 images; odd: 1 identical copy (copy.jpg is 0.jpg), "
        "2 sizes (5 of 40 x 30, 1 of 20 x 15, such as small.jpg)"
    )


def test_cameras_and_gaps_in_time() -> None:
    found = {
        f"{number}.jpg": Metadata(
            camera="DJI FC330" if number < 9 else "Parrot Anafi",
            taken=BEGIN + timedelta(seconds=3 * number + (7200 if number > 5 else 0)),
        )
        for number in range(10)
    }
    assert oddities({}, found) == [
        "2 cameras (9 of DJI FC330, 1 of Parrot Anafi, such as 9.jpg)",
        "a gap in time of 2 h 00 min before 6.jpg",
    ]
    even = {name: Metadata(taken=BEGIN + timedelta(hours=int(name[0]))) for name in found}
    assert oddities({}, even) == []


def test_a_folder_may_have_the_name_of_a_kind(
    flight: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(flight.parent)
    shutil.copytree(flight, "synthetic")
    dataset = open_dataset("synthetic")
    assert len(dataset.images) == 3
    assert dataset.notes == (
        "synthetic is a folder here; write synthetic: for the kind of dataset of that name",
    )
    assert open_dataset("synthetic:", max_width=100).geometry == "homography"
    Path("synthetic/run.json").write_text("{}")
    assert open_dataset("synthetic", max_width=100).geometry == "homography"


def test_a_folder_that_cannot_be_read_is_told(tmp_path: Path) -> None:
    with pytest.raises(DatasetError, match="cannot read the folder"):
        list_images(tmp_path / "gone")
