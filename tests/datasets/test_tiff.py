"""TIFF files of many kinds: bands, pages, signs, and what has no data."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image as PillowImage

from aerocues.datasets.catalog import open_dataset
from aerocues.datasets.decoding import FileSource
from aerocues.errors import DatasetError, ImageError
from tests.datasets.tiff_files import tiff_bytes, write_tiff

Bgr = NDArray[np.uint8]


def gray(path: Path, **options: Any) -> NDArray[np.uint8]:
    bgr = FileSource(path, **options).read().bgr
    assert np.array_equal(bgr[..., 0], bgr[..., 2])
    return bgr[..., 0]


@pytest.fixture
def bands() -> NDArray[np.uint8]:
    """Seven bands, each different: (50, 70, 7)."""
    return np.random.default_rng(1).integers(0, 256, (50, 70, 7)).astype(np.uint8)


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("tile", [0, 32])
@pytest.mark.parametrize(
    "stored", [{}, {"planar": True}, {"deflate": True}, {"deflate": True, "predictor": 2}]
)
@pytest.mark.parametrize("count", [5, 7])
def test_a_band_of_many_is_read(
    tmp_path: Path, bands: Bgr, order: str, tile: int, stored: dict[str, Any], count: int
) -> None:
    path = write_tiff(tmp_path / "a.tif", bands[..., :count], order=order, tile=tile, **stored)
    for band in (1, 3, count):
        assert np.array_equal(gray(path, band=band), bands[..., band - 1])
    assert FileSource(path, band=2).is_gray()


@pytest.mark.parametrize("predictor", [1, 2])
def test_deep_bands_are_read(tmp_path: Path, bands: Bgr, predictor: int) -> None:
    deep = bands.astype(np.uint16) * 200 + 1000
    path = write_tiff(tmp_path / "a.tif", deep, deflate=True, predictor=predictor)
    stored = FileSource(path, band=6).stored()
    assert np.array_equal(stored.values, deep[..., 5])


@pytest.mark.parametrize("count", [2, 3, 4])
def test_a_band_of_a_few_is_read(tmp_path: Path, bands: Bgr, count: int) -> None:
    path = write_tiff(tmp_path / "a.tif", bands[..., :count])
    for band in range(1, count + 1):
        assert np.array_equal(gray(path, band=band), bands[..., band - 1])


def test_bands_must_be_chosen(tmp_path: Path, bands: Bgr, picture: Bgr) -> None:
    path = write_tiff(tmp_path / "a.tif", bands)
    for band in (None, 8):
        with pytest.raises(ImageError, match=r"7 bands.*`band`"):
            FileSource(path, band=band).read()
    cv2.imwrite(str(tmp_path / "colour.png"), picture)
    assert np.array_equal(gray(tmp_path / "colour.png", band=1), picture[..., 2])
    write_tiff(tmp_path / "b.tif", bands)
    (tmp_path / "colour.png").unlink()
    with pytest.raises(DatasetError, match=r"2 of 2 images.*`band`, from 1 to 7"):
        open_dataset(str(tmp_path))
    opened = open_dataset(str(tmp_path), band=7)
    assert np.array_equal(opened.images[1].read().bgr[..., 0], bands[..., 6])
    assert dict(opened.settings)["band"] == "7"


@pytest.mark.parametrize("kind", [np.uint8, np.uint16])
@pytest.mark.parametrize("planar", [False, True])
@pytest.mark.parametrize("extra", [(), (0,), (2,)])
def test_what_follows_the_colours_may_be_infrared_or_alpha(
    tmp_path: Path, bands: Bgr, kind: Any, planar: bool, extra: tuple[int, ...]
) -> None:
    values = bands[..., : 3 + len(extra)].astype(kind)
    values[:9, :, 3:] = 0
    options = {"photometric": 2, "planar": planar, "tags": {338: extra} if extra else {}}
    path = write_tiff(tmp_path / "a.tif", values, **options)
    stored = FileSource(path).stored()
    if extra == (2,):
        assert stored.valid is not None
        assert np.array_equal(stored.valid, values[..., 3] > 0)
        return
    assert stored.valid is None
    assert np.array_equal(stored.values, values[..., 2::-1])
    for band in range(1, values.shape[2] + 1):
        assert np.array_equal(FileSource(path, band=band).stored().values, values[..., band - 1])


def test_pages_of_one_size_are_bands(tmp_path: Path, bands: Bgr) -> None:
    pages = [np.ascontiguousarray(bands[..., i]) for i in range(3)]
    path = write_tiff(tmp_path / "a.tif", *pages)
    with pytest.raises(ImageError, match="3 bands"):
        FileSource(path).read()
    assert np.array_equal(gray(path, band=3), pages[2])


@pytest.mark.parametrize("kinds", [(1, 0), (0, 0)])
def test_a_thumbnail_on_the_first_page_is_left_out(
    tmp_path: Path, picture: Bgr, kinds: tuple[int, ...]
) -> None:
    thumbnail, rgb = picture[::4, ::4, ::-1], picture[..., ::-1]
    path = write_tiff(tmp_path / "a.tif", thumbnail, rgb, photometric=2, kinds=kinds)
    source = FileSource(path)
    assert source.size() == (80, 60)
    assert np.array_equal(source.read().bgr, picture)


@pytest.mark.parametrize("kind", [np.uint8, np.uint16, np.float32])
def test_white_may_be_the_least_value(tmp_path: Path, bands: Bgr, kind: Any) -> None:
    values = bands[..., 0].astype(kind)
    inverted = -values if kind == np.float32 else np.iinfo(kind).max - values
    plain = write_tiff(tmp_path / "plain.tif", values)
    negative = write_tiff(tmp_path / "negative.tif", inverted, photometric=0)
    assert np.array_equal(gray(negative), gray(plain))


@pytest.mark.parametrize("kind", [np.uint8, np.uint16, np.int16, np.float32, np.float64])
def test_what_has_no_data_is_no_content(tmp_path: Path, bands: Bgr, kind: Any) -> None:
    values = bands[..., 0].astype(kind)
    nodata = 7 if kind in (np.uint8, np.uint16) else -10_000
    values[:5] = nodata
    path = write_tiff(tmp_path / "a.tif", values, tags={42113: str(nodata)})
    pixels = FileSource(path).read()
    assert pixels.valid is not None
    assert np.array_equal(pixels.valid, values != nodata)
    assert pixels.bgr[pixels.valid].min() == 0
    assert pixels.bgr[pixels.valid].max() >= 254


@pytest.mark.parametrize("planar", [False, True])
@pytest.mark.parametrize("part", [0.4, 0.95])
def test_a_tiff_that_is_cut_short_is_refused(
    tmp_path: Path, picture: Bgr, planar: bool, part: float
) -> None:
    large = cv2.resize(picture, (320, 240))
    content = tiff_bytes(large, photometric=2, planar=planar)
    # The directory is at the end, or where Pillow writes it: at the beginning.
    buffer = io.BytesIO()
    PillowImage.fromarray(large).save(buffer, "TIFF")
    whole = buffer.getvalue() if not planar else content
    path = tmp_path / "cut.tif"
    path.write_bytes(whole[: int(len(whole) * part)])
    with pytest.raises(ImageError, match=r"cut\.tif"):
        FileSource(path).read()


@pytest.mark.parametrize("place", [0.2, 0.5, 0.8])
def test_a_packed_tiff_with_a_hole_is_refused(tmp_path: Path, picture: Bgr, place: float) -> None:
    large = cv2.resize(picture, (320, 240))
    data = bytearray(tiff_bytes(large, photometric=2, deflate=True))
    start = int(place * len(data))
    data[start : start + 900] = bytes(900)
    path = tmp_path / "hole.tif"
    path.write_bytes(data)
    with pytest.raises(ImageError, match=r"hole\.tif.*damaged"):
        FileSource(path).read()
