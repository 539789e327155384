"""One bad file among the images costs its own pairs, and is told."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import pytest

import aerocues
from tests.cli.conftest import Call

TWO = ("--combinations", "ORB-ORB-HAM-BF,AKAZE-AKAZE-HAM-BF", "--workers", 1)
LARGE_WEBP = b"RIFF\x16\0\0\0WEBPVP8L\x0d\0\0\0\x2f\xaf\xb6\xab\x0d\0\0\0\0\0\0\0\0\0"


@pytest.fixture
def images(photos: Path, tmp_path: Path) -> Path:
    folder = tmp_path / "images"
    shutil.copytree(photos, folder)
    return folder


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("1.png", b"\x89PNG\r\n\x1a\n"),
        ("1.webp", LARGE_WEBP),
        ("1.tif", b"II*\0\xff\xff\xff\x7f"),
        ("1.jpg", b"\xff\xd8\xff\xe1\0\x08Exif\0\0"),
    ],
)
def test_the_other_pairs_are_measured(
    call: Call, images: Path, tmp_path: Path, name: str, content: bytes
) -> None:
    (images / "1.png").unlink()
    (images / name).write_bytes(content)
    answer = call("run", images, "-o", tmp_path / "results", *TWO)
    assert answer.code == 0
    rows = aerocues.Results(tmp_path / "results").table()
    for row in rows.iter_rows(named=True):
        bad = name in (row["image_1"], row["image_2"])
        assert (row["status"] == "error") == bad
        assert (name in (row["message"] or "")) == bad


def test_names_need_not_be_unicode(call: Call, photos: Path, tmp_path: Path) -> None:
    folder = Path(os.fsdecode(os.fsencode(tmp_path) + b"/Fl\xfcge"))
    folder.mkdir()
    for number in range(3):
        name = os.fsdecode(b"\xe4%d.png" % number)
        shutil.copy(photos / f"{number}.png", folder / name)
    (folder / os.fsdecode(b"\xe41.png")).write_bytes(b"no image")
    answer = call("run", folder, "-o", tmp_path / "results", *TWO)
    assert answer.code == 1
    rows = aerocues.Results(tmp_path / "results").table()
    assert set(rows["dataset"]) == {r"Fl\xfcge"}
    assert set(rows["image_2"]) == {r"\xe41.png", r"\xe42.png"}
    assert all(r"Fl\xfcge/\xe41.png" in message for message in rows["message"])
    for words in (("status",), ("results",), ("results", "--csv", tmp_path / "rows.csv")):
        assert call(words[0], tmp_path / "results", *words[1:]).code == 0


def test_a_run_of_errors_ends_with_the_reason(call: Call, images: Path, tmp_path: Path) -> None:
    for path in images.iterdir():
        path.write_bytes(path.read_bytes()[:200])
    answer = call("run", images, "-o", tmp_path / "results", *TWO)
    assert answer.code == 1
    assert "0.png cannot be decoded" in answer.out
    assert "--max-width" not in answer.out


@pytest.mark.slow
@pytest.mark.parametrize("pairs", [(), ("--pairs", "exhaustive")])
def test_a_recommendation_tells_what_it_left_out(
    call: Call, images: Path, tmp_path: Path, pairs: tuple[str, ...]
) -> None:
    (images / "1.png").write_bytes((images / "1.png").read_bytes()[:5000])
    words = ("--max-pairs", 6, "--budget", "1h", "--no-final", "--max-keypoints", 300, *pairs)
    answer = call("recommend", images, "-o", tmp_path / "race", *TWO, *words)
    assert answer.code == 0
    assert "left out" in answer.out
    assert "1.png cannot be decoded" in " ".join(answer.out.split())
    assert ">99%" not in answer.out
