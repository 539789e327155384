from __future__ import annotations

from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from aerocues.datasets.catalog import open_dataset
from aerocues.datasets.dataset import Dataset
from aerocues.datasets.fitting import fitted_size, scale_matrix
from aerocues.datasets.homography_sequences import read_homography
from aerocues.errors import DatasetError, ImageError

SHIFT = "1 0 5\n0 1 -3\n0 0 1\n"


def make_sequence(folder: Path, picture: Any, image: str, homography: str, count: int = 3) -> Path:
    folder.mkdir(parents=True)
    for number in range(1, count + 1):
        cv2.imwrite(str(folder / image.format(number)), picture)
        if number > 1:
            (folder / homography.format(number)).write_text(SHIFT)
    return folder


@pytest.fixture
def oxford(tmp_path: Path, picture: NDArray[np.uint8]) -> Path:
    root = tmp_path / "oxford"
    make_sequence(root / "graf", picture, "img{}.ppm", "H1to{}p")
    make_sequence(root / "boat", picture[..., 0], "img{}.pgm", "H1to{}p")
    return root


def test_sequences_and_their_truth(oxford: Path) -> None:
    dataset = open_dataset(f"oxford:{oxford}")
    assert [(p.index, p.sequence, p.image_1, p.image_2) for p in dataset.pairs] == [
        (0, "boat", "boat/img1.pgm", "boat/img2.pgm"),
        (1, "boat", "boat/img1.pgm", "boat/img3.pgm"),
        (2, "graf", "graf/img1.ppm", "graf/img2.ppm"),
        (3, "graf", "graf/img1.ppm", "graf/img3.ppm"),
    ]
    assert (dataset.name, dataset.geometry) == ("oxford", "homography")
    assert dataset.image("boat/img1.pgm").source.is_gray()
    truth = dataset.pairs[0].homography
    assert truth is not None
    assert truth.tolist() == [[1, 0, 5], [0, 1, -3], [0, 0, 1]]


def test_one_sequence_alone_is_a_dataset_too(oxford: Path) -> None:
    dataset = open_dataset(f"oxford:{oxford / 'graf'}")
    assert {p.sequence for p in dataset.pairs} == {"graf"}
    assert dataset.images[0].name == "graf/img1.ppm"


def test_an_image_without_a_header_leaves_the_others_as_they_are(oxford: Path) -> None:
    whole = open_dataset(f"oxford:{oxford}", max_width=40)
    (oxford / "graf" / "img2.ppm").write_bytes(b"")
    dataset = open_dataset(f"oxford:{oxford}", max_width=40)
    assert len(dataset.pairs) == 4
    broken = dataset.image("graf/img2.ppm")
    assert not broken.source.is_gray()
    with pytest.raises(ImageError, match=r"img2\.ppm"):
        broken.read()
    for index in (0, 1, 3):
        after, before = dataset.pairs[index].homography, whole.pairs[index].homography
        assert after is not None
        assert before is not None
        assert after.tolist() == before.tolist()


def test_hpatches(tmp_path: Path, picture: NDArray[np.uint8]) -> None:
    make_sequence(tmp_path / "v_wall", picture, "{}.png", "H_1_{}", count=6)
    (tmp_path / "v_wall" / "10.txt").write_text("no image")
    for path in (tmp_path, tmp_path / "v_wall"):
        dataset = open_dataset(f"hpatches:{path}")
        assert len(dataset.pairs) == 5
        assert dataset.name == "hpatches"


@pytest.mark.parametrize("content", ["", "1 2 3", "a b c d e f g h i", "0 " * 9, "nan " * 9])
def test_a_bad_homography_is_refused_by_name(oxford: Path, content: str) -> None:
    (oxford / "graf" / "H1to3p").write_text(content)
    with pytest.raises(DatasetError, match="H1to3p"):
        open_dataset(f"oxford:{oxford}")


def test_missing_files_are_named(oxford: Path) -> None:
    (oxford / "graf" / "H1to2p").unlink()
    with pytest.raises(DatasetError, match="H1to2p"):
        open_dataset(f"oxford:{oxford}")
    (oxford / "graf" / "img1.ppm").unlink()
    with pytest.raises(DatasetError, match="image 1"):
        open_dataset(f"oxford:{oxford}")
    with pytest.raises(DatasetError, match="fetch hpatches"):
        open_dataset(f"hpatches:{oxford}")


sizes = st.tuples(st.integers(20, 5000), st.integers(20, 5000))


@given(size=sizes, max_width=st.integers(16, 5000))
def test_scaling_maps_the_area_of_the_picture_onto_the_new_one(
    size: tuple[int, int], max_width: int
) -> None:
    new = fitted_size(size, max_width)
    matrix = scale_matrix(size, new)
    assert new[0] == min(size[0], max_width)
    corner = matrix @ np.array([size[0] - 0.5, size[1] - 0.5, 1.0])
    assert corner[:2] == pytest.approx([new[0] - 0.5, new[1] - 0.5])
    assert matrix @ np.array([-0.5, -0.5, 1.0]) == pytest.approx([-0.5, -0.5, 1.0])


def sift_errors(dataset: Dataset, index: int) -> NDArray[np.float64]:
    """Offsets (M, 2) of mutual SIFT matches (ratio test 0.8) from the true places."""
    pair = dataset.pairs[index]
    assert pair.homography is not None
    sift: Any = cv2.SIFT_create()
    sides = [
        sift.detectAndCompute(dataset.image(name).read().bgr, None)
        for name in (pair.image_1, pair.image_2)
    ]
    matcher = cv2.BFMatcher(cv2.NORM_L2)
    good = [
        best
        for best, second in matcher.knnMatch(sides[0][1], sides[1][1], k=2)
        if best.distance < 0.8 * second.distance
    ]
    start = np.array([(*sides[0][0][m.queryIdx].pt, 1.0) for m in good])
    end = np.array([sides[1][0][m.trainIdx].pt for m in good])
    moved = start @ pair.homography.T
    return np.asarray(end - moved[:, :2] / moved[:, 2:])


def test_truth_of_graf_follows_the_size(shared_data: Path) -> None:
    dataset = open_dataset(f"oxford:{shared_data / 'oxford'}", max_width=400, sequences=["graf"])
    assert dataset.image("graf/img1.png").read().bgr.shape == (320, 400, 3)
    for index, least in ((0, 100), (1, 60)):
        errors = np.linalg.norm(sift_errors(dataset, index), axis=1)
        assert len(errors) > least
        assert float(np.median(errors)) < 1.5


def test_truth_of_hpatches_follows_sizes_that_differ(shared_data: Path) -> None:
    dataset = open_dataset(f"hpatches:{shared_data / 'hpatches'}", max_width=500, max_pairs=1)
    errors = np.linalg.norm(sift_errors(dataset, 0), axis=1)
    assert float(np.median(errors)) < 1.5


def test_the_whole_of_oxford(shared_data: Path) -> None:
    dataset = open_dataset(f"oxford:{shared_data / 'oxford'}")
    assert (len(dataset.images), len(dataset.pairs)) == (48, 40)
    gray = {image.name.split("/")[0] for image in dataset.images if image.source.is_gray()}
    assert gray == {"boat"}


def test_read_homography(tmp_path: Path) -> None:
    file = tmp_path / "H"
    file.write_text(" 1.5e0 0\t0\n0 2 0 0 0 1")
    assert np.array_equal(read_homography(file), np.diag([1.5, 2.0, 1.0]))


@pytest.mark.parametrize(
    "content",
    [
        "1.5 0 0\n0 2 0\n0 0 1".encode("utf-8-sig"),
        "1.5 0 0\n0 2 0\n0 0 1".encode("utf-16"),
        b"1.5, 0, 0\n0, 2, 0\n0, 0, 1\n",
        b"1.5,0,0,0,2,0,0,0,1",
        b"1,5 0 0\n0 2,0 0\n0 0 1",
        b"1,5;0;0;0;2;0;0;0;1",
        b"[[1.5, 0, 0], [0, 2, 0], [0, 0, 1]]",
        b"[1.5 0 0; 0 2 0; 0 0 1]",
        b"# H 1 to 2\n1.5 0 0 // first\n% second\n0 2 0\n0 0 1 # end",
        b"1.5 0 0\r0 2 0\r0 0 1",
    ],
)
def test_a_homography_is_read_as_programs_write_it(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "H").write_bytes(content)
    assert np.array_equal(read_homography(tmp_path / "H"), np.diag([1.5, 2.0, 1.0]))


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (b"1 0 0 0 1 0 0 0", "8 numbers in place of nine"),
        (b"1 0 0 0 1 0 0 0 1 0", "10 numbers"),
        (b"1 0 0 0 x 0 0 0 1", "'x'"),
        (b"1 0 0 0 inf 0 0 0 1", "not finite"),
        (b"\xff\xd8\xff\xe0", "not UTF-8"),
    ],
)
def test_what_is_wrong_with_a_homography_is_told(tmp_path: Path, content: bytes, told: str) -> None:
    (tmp_path / "H").write_bytes(content)
    with pytest.raises(DatasetError, match=told):
        read_homography(tmp_path / "H")
