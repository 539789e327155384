"""Deep, multispectral, damaged and otherwise unusual image files."""

from __future__ import annotations

import os
import zlib
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image as PillowImage

from aerocues.datasets.catalog import open_dataset
from aerocues.datasets.dataset import GpsPosition
from aerocues.datasets.decoding import FileSource
from aerocues.datasets.levels import Levels, robust_levels
from aerocues.errors import DatasetError, ImageError
from tests.datasets.tiff_files import write_tiff

Bgr = NDArray[np.uint8]


@pytest.fixture
def bands() -> NDArray[np.uint8]:
    """Seven bands, each different: (50, 70, 7)."""
    return np.random.default_rng(1).integers(0, 256, (50, 70, 7)).astype(np.uint8)


def test_the_range_of_values_leaves_out_highlights_and_faults() -> None:
    values = np.concatenate([np.linspace(1000, 2000, 10_000), [65_535.0], [0.0]])
    found = robust_levels(values)
    assert found.low == pytest.approx(1000 + 5 - 0.25 * 990, abs=1)
    assert found.high == pytest.approx(2000 - 5 + 0.25 * 990, abs=1)
    assert robust_levels(np.linspace(-5, 20, 500)) == Levels(-5.0, 20.0)
    assert Levels(10, 20).scaled(np.array([0.0, 10, 15, 20, 99, np.nan, np.inf])).tolist() == [
        *(0, 0, 128, 255, 255, 0, 255)
    ]


@pytest.mark.parametrize("kind", [np.uint16, np.float32])
def test_images_of_a_scene_are_scaled_alike(tmp_path: Path, bands: Bgr, kind: Any) -> None:
    values = bands[..., 0].astype(kind) * 10 + 30_000
    for number in range(4):
        own = values.copy()
        if number % 2:
            own[0, :3] = 65_535
        write_tiff(tmp_path / f"{number}.tif", own)
    dataset = open_dataset(str(tmp_path))
    pixels = [image.read().bgr for image in dataset.images]
    assert np.array_equal(pixels[0][1:], pixels[1][1:])
    assert int(pixels[0].max()) - int(pixels[0].min()) > 150
    assert dict(dataset.settings)["values"].startswith("30000 to 3")
    keys = {image.source.content_key() for image in dataset.images}
    assert keys.isdisjoint({FileSource(path).content_key() for path in tmp_path.iterdir()})


def test_sound_files_of_8_bits_keep_their_keys(tmp_path: Path, picture: Bgr) -> None:
    path = tmp_path / "a.png"
    cv2.imwrite(str(path), picture)
    source = FileSource(path)
    assert source.is_plain()
    assert FileSource(path, levels=Levels(0, 1)).content_key() == source.content_key()


def camera_names(folder: Path, labels: list[str], exposures: int = 3) -> None:
    values = np.random.default_rng(0).integers(0, 4000, (30, 40)).astype(np.uint16)
    for exposure in range(exposures):
        for label in labels:
            write_tiff(folder / f"IMG_{exposure:04d}_{label}.tif", values)


@pytest.mark.parametrize(
    "labels", [list("12345"), ["GRE", "NIR", "RED", "REG"], ["MS_G", "MS_NIR", "MS_R", "MS_RE"]]
)
def test_bands_in_files_are_asked_about(tmp_path: Path, labels: list[str]) -> None:
    camera_names(tmp_path, labels)
    with pytest.raises(DatasetError, match=f"{len(labels)} bands of each exposure.*`band`"):
        open_dataset(str(tmp_path))
    names = [image.name for image in open_dataset(str(tmp_path), band=2).images]
    assert names == [f"IMG_{exposure:04d}_{labels[1]}.tif" for exposure in range(3)]
    assert len(open_dataset(str(tmp_path), subset=f"*_{labels[0]}.tif").images) == 3


def test_numbers_at_the_end_of_names_need_not_be_bands(tmp_path: Path, picture: Bgr) -> None:
    for name in ("strip1_1", "strip1_2", "strip2_1", "strip2_2"):
        cv2.imwrite(str(tmp_path / f"{name}.tif"), picture)
    assert len(open_dataset(str(tmp_path)).images) == 4


def jpeg(picture: Bgr, progressive: bool = False) -> bytearray:
    large = cv2.resize(picture, (640, 480))
    options = [cv2.IMWRITE_JPEG_PROGRESSIVE, int(progressive)]
    return bytearray(bytes(cv2.imencode(".jpg", large, options)[1]))


@pytest.mark.parametrize("progressive", [False, True])
@pytest.mark.parametrize("damage", ["zeros to the end", "zeros", "hole"])
def test_a_jpeg_that_lacks_data_is_refused(
    tmp_path: Path, picture: Bgr, progressive: bool, damage: str, capfd: pytest.CaptureFixture[str]
) -> None:
    data = jpeg(picture, progressive)
    middle = len(data) // 2
    if damage == "zeros to the end":
        data[middle:-2] = bytes(len(data) - 2 - middle)
    elif damage == "zeros":
        data[middle : middle + 2000] = bytes(2000)
    else:
        del data[middle : middle + 2000]
    path = tmp_path / "damaged.jpg"
    path.write_bytes(data)
    with pytest.raises(ImageError, match=r"damaged\.jpg.*Corrupt JPEG data"):
        FileSource(path).read()
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize("padding", [b"", b"\0" * 16, b"\0" * 40])
def test_a_jpeg_may_be_padded_before_its_end(tmp_path: Path, picture: Bgr, padding: bytes) -> None:
    data = jpeg(picture)
    path = tmp_path / "padded.jpg"
    path.write_bytes(data[:-2] + padding + data[-2:])
    assert FileSource(path).read().bgr.shape == (480, 640, 3)


def test_what_others_write_meanwhile_is_kept(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    decode = cv2.imdecode

    def talkative(*arguments: Any) -> Any:
        os.write(2, b"a progress bar\n")
        return decode(*arguments)

    path = write_tiff(tmp_path / "a.tif", np.zeros((20, 30), np.uint8), tags={42113: "5"})
    monkeypatch.setattr(cv2, "imdecode", talkative)
    FileSource(path).read()
    assert capfd.readouterr().err == "a progress bar\n"


def test_a_large_text_in_a_png_is_no_fault(tmp_path: Path, picture: Bgr) -> None:
    data = bytes(cv2.imencode(".png", picture)[1])
    text = b"XML:com.adobe.xmp\0\1\0\0\0" + zlib.compress(b"x" * 3_000_000)
    chunk = len(text).to_bytes(4, "big") + b"iTXt" + text
    chunk += zlib.crc32(b"iTXt" + text).to_bytes(4, "big")
    path = tmp_path / "large.png"
    path.write_bytes(data[:33] + chunk + data[33:])
    assert np.array_equal(FileSource(path).read().bgr, picture)


def test_a_webp_of_many_megapixels_costs_no_memory(tmp_path: Path, picture: Bgr) -> None:
    body = b"\x2f" + (13_999 | 13_999 << 14).to_bytes(4, "little") + bytes(8)
    chunk = b"VP8L" + len(body).to_bytes(4, "little") + body
    riff = b"RIFF" + (len(chunk) + 4).to_bytes(4, "little") + b"WEBP" + chunk
    path = tmp_path / "large.webp"
    path.write_bytes(riff)
    assert FileSource(path).size() == (14_000, 14_000)
    with pytest.raises(ImageError, match=r"large\.webp"):
        FileSource(path).read()
    for options, channels in (([], 3), ([cv2.IMWRITE_WEBP_QUALITY, 101], 4)):
        alpha = np.full((60, 80, 1), 200, np.uint8)
        pixels = np.concatenate([picture, alpha], axis=2)[..., :channels]
        path.write_bytes(bytes(cv2.imencode(".webp", pixels, options)[1]))
        assert FileSource(path).size() == (80, 60)


@pytest.mark.parametrize("orientation", [1, 6])
def test_heic_is_read_where_pillow_heif_is_installed(
    tmp_path: Path, picture: Bgr, orientation: int
) -> None:
    heif = pytest.importorskip("pillow_heif")
    rgb = np.ascontiguousarray(picture[..., ::-1])
    turned = rgb if orientation == 1 else np.ascontiguousarray(np.rot90(rgb))
    exif = PillowImage.Exif()
    exif[274], exif[272] = orientation, "Phone"
    exif[0x8825] = {1: "N", 2: (46.0, 30.0, 0.0), 3: "E", 4: (9.0, 0.0, 0.0)}
    for name in ("a.heic", "b.heic"):
        image = heif.from_pillow(PillowImage.fromarray(turned))
        image.save(tmp_path / name, quality=95, exif=exif.tobytes())
    dataset = open_dataset(str(tmp_path))
    assert len(dataset.images) == 2
    bgr = dataset.images[0].read().bgr
    assert bgr.shape == picture.shape
    assert float(np.abs(bgr.astype(int) - picture).mean()) < 8
    assert dataset.images[0].gps == GpsPosition(46.5, 9.0)
    path = tmp_path / "a.heic"
    path.write_bytes(path.read_bytes()[:-300])
    with pytest.raises(ImageError, match=r"a\.heic"):
        FileSource(path).read()
