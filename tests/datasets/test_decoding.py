from __future__ import annotations

import io
import pickle
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image as PillowImage

from aerocues.datasets.decoding import FileSource
from aerocues.errors import ArgumentError, ImageError

Bgr = NDArray[np.uint8]


def save(path: Path, bgr: Any, **options: Any) -> Path:
    """Write with Pillow, from BGR(A) or gray values."""
    order = [2, 1, 0, 3][: bgr.shape[2]] if bgr.ndim == 3 else slice(None)
    PillowImage.fromarray(np.ascontiguousarray(bgr[..., order])).save(path, **options)
    return path


@pytest.mark.parametrize("suffix", ["png", "bmp", "tif", "ppm", "webp"])
def test_lossless_formats_keep_every_pixel(tmp_path: Path, picture: Bgr, suffix: str) -> None:
    options = {"lossless": True} if suffix == "webp" else {}
    path = save(tmp_path / f"image.{suffix}", picture, **options)
    pixels = FileSource(path).read()
    assert pixels.bgr.dtype == np.uint8
    assert np.array_equal(pixels.bgr, picture)
    assert pixels.valid is None


def test_jpeg_pixels_are_those_of_opencv(tmp_path: Path, picture: Bgr) -> None:
    for options in ({"quality": 90}, {"quality": 90, "progressive": True}):
        path = save(tmp_path / "image.jpg", picture, **options)
        expected = cv2.imread(str(path), cv2.IMREAD_COLOR)
        assert np.array_equal(FileSource(path).read().bgr, expected)


@pytest.mark.parametrize("suffix", ["png", "tif", "jpg", "pgm", "bmp"])
def test_gray_gives_three_equal_channels(tmp_path: Path, picture: Bgr, suffix: str) -> None:
    source = FileSource(save(tmp_path / f"gray.{suffix}", picture[..., 1]))
    bgr = source.read().bgr
    assert source.is_gray()
    assert bgr.shape == (60, 80, 3)
    assert np.array_equal(bgr[..., 0], bgr[..., 1])
    assert np.array_equal(bgr[..., 0], bgr[..., 2])


def test_colour_is_not_gray(tmp_path: Path, picture: Bgr) -> None:
    assert not FileSource(save(tmp_path / "colour.png", picture)).is_gray()


@pytest.mark.parametrize("suffix", ["png", "tiff"])
@pytest.mark.parametrize("bits", [10, 12, 14, 16])
def test_deep_pictures_are_scaled_by_their_sensor_depth(
    tmp_path: Path, picture: Bgr, suffix: str, bits: int
) -> None:
    for values in (picture, picture[..., 0]):
        deep = np.rint(values * ((2**bits - 1) / 255)).astype(np.uint16)
        path = tmp_path / f"deep.{suffix}"
        cv2.imwrite(str(path), deep)
        expected = values if values.ndim == 3 else np.repeat(values[..., None], 3, axis=2)
        got = FileSource(path).read().bgr
        assert int(np.abs(got.astype(int) - expected).max()) <= 1


def test_floating_point_is_stretched_and_holes_are_invalid(tmp_path: Path) -> None:
    values = np.linspace(-5, 20, 600, dtype=np.float32).reshape(20, 30)
    values[3, 4] = np.nan
    path = tmp_path / "thermal.tiff"
    cv2.imwrite(str(path), values)
    pixels = FileSource(path).read()
    assert pixels.bgr[0, 0, 0] == 0
    assert pixels.bgr[-1, -1, 0] == 255
    assert pixels.valid is not None
    assert np.argwhere(~pixels.valid).tolist() == [[3, 4]]


@pytest.mark.parametrize("suffix", ["png", "tif", "webp"])
def test_transparent_pixels_are_black_and_invalid(
    tmp_path: Path, picture: Bgr, suffix: str
) -> None:
    alpha = np.full((60, 80, 1), 255, np.uint8)
    alpha[:10] = 0
    alpha[10:20] = 255 if suffix == "tif" else 128
    options = {"lossless": True, "exact": True} if suffix == "webp" else {}
    path = save(tmp_path / f"a.{suffix}", np.concatenate([picture, alpha], axis=2), **options)
    pixels = FileSource(path).read()
    assert pixels.valid is not None
    assert np.array_equal(pixels.valid, alpha[..., 0] > 0)
    assert not pixels.bgr[:10].any()
    assert np.array_equal(pixels.bgr[10:], picture[10:])


def test_opaque_alpha_palette_and_cmyk(tmp_path: Path, picture: Bgr) -> None:
    opaque = np.concatenate([picture, np.full((60, 80, 1), 255, np.uint8)], axis=2)
    pixels = FileSource(save(tmp_path / "opaque.png", opaque)).read()
    assert pixels.valid is None
    assert np.array_equal(pixels.bgr, picture)
    rgb = PillowImage.fromarray(np.ascontiguousarray(picture[..., ::-1]))
    rgb.quantize(64).save(tmp_path / "palette.png")
    expected = np.asarray(rgb.quantize(64).convert("RGB"))[..., ::-1]
    assert np.array_equal(FileSource(tmp_path / "palette.png").read().bgr, expected)
    rgb.convert("CMYK").save(tmp_path / "cmyk.tif")
    got = FileSource(tmp_path / "cmyk.tif").read()
    assert got.valid is None
    assert float(np.abs(got.bgr.astype(int) - picture).mean()) < 4


@pytest.mark.parametrize("orientation", range(1, 9))
@pytest.mark.parametrize("suffix", ["png", "jpg", "webp", "tif"])
def test_exif_orientation_is_honoured(
    tmp_path: Path, picture: Bgr, suffix: str, orientation: int
) -> None:
    turned_back = {
        1: picture,
        2: picture[:, ::-1],
        3: picture[::-1, ::-1],
        4: picture[::-1],
        5: picture.transpose(1, 0, 2),
        6: np.rot90(picture, 1),
        7: picture[::-1, ::-1].transpose(1, 0, 2),
        8: np.rot90(picture, -1),
    }[orientation]
    exif = PillowImage.Exif()
    exif[274] = orientation
    options: dict[str, dict[str, Any]] = {"jpg": {"quality": 95}, "webp": {"lossless": True}}
    path = save(tmp_path / f"turned.{suffix}", turned_back, exif=exif, **options.get(suffix, {}))
    source = FileSource(path)
    bgr = source.read().bgr
    assert source.size() == (80, 60)
    assert bgr.shape == picture.shape
    assert float(np.abs(bgr.astype(int) - picture).mean()) < (4 if suffix == "jpg" else 0.01)


@pytest.mark.parametrize("name", ["a.jpg", "progressive.jpg", "a.png", "a.webp", "a.tif", "a.bmp"])
@pytest.mark.parametrize("part", [0.1, 0.5, 0.97])
def test_truncated_files_are_refused_by_name(
    tmp_path: Path, picture: Bgr, name: str, part: float
) -> None:
    path = save(tmp_path / name, picture, **({"progressive": True} if "prog" in name else {}))
    data = path.read_bytes()
    path.write_bytes(data[: int(len(data) * part)])
    with pytest.raises(ImageError, match=name):
        FileSource(path).read()


def test_a_thumbnail_does_not_hide_that_the_picture_is_cut_off(
    tmp_path: Path, picture: Bgr
) -> None:
    thumbnail = io.BytesIO()
    PillowImage.fromarray(picture[::4, ::4]).save(thumbnail, "JPEG")
    segment = thumbnail.getvalue()
    plain = save(tmp_path / "plain.jpg", picture).read_bytes()
    application = b"\xff\xe5" + (len(segment) + 2).to_bytes(2, "big") + segment
    path = tmp_path / "camera.jpg"
    path.write_bytes(plain[:2] + application + plain[2:] + b"trailing maker notes")
    assert FileSource(path).read().bgr.shape == (60, 80, 3)
    path.write_bytes((plain[:2] + application + plain[2:])[:-400])
    with pytest.raises(ImageError, match="truncated"):
        FileSource(path).read()


def test_a_damaged_png_is_refused(tmp_path: Path, picture: Bgr) -> None:
    path = save(tmp_path / "damaged.png", picture)
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 0xFF
    path.write_bytes(bytes(data))
    with pytest.raises(ImageError, match="checksum"):
        FileSource(path).read()


@pytest.mark.parametrize(
    "content", [b"", b"hello", b"\xff\xd8\xff", b"\x89PNG\r\n\x1a\n", b"II*\x00"]
)
def test_what_is_no_image_is_refused(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "fake.jpg"
    path.write_bytes(content)
    for action in (FileSource(path).read, FileSource(path).size):
        with pytest.raises(ImageError, match=r"fake\.jpg"):
            action()
    assert not FileSource(path).is_gray()


def test_a_missing_file_says_so(tmp_path: Path) -> None:
    source = FileSource(tmp_path / "gone.jpg")
    for action in (source.read, source.content_key, source.size):
        with pytest.raises(ImageError, match=r"gone\.jpg: No such file"):
            action()


def test_max_width_shrinks_by_area_and_never_enlarges(tmp_path: Path, picture: Bgr) -> None:
    path = save(tmp_path / "image.png", picture)
    assert FileSource(path, max_width=40).size() == (40, 30)
    expected = cv2.resize(picture, (40, 30), interpolation=cv2.INTER_AREA)
    assert np.array_equal(FileSource(path, max_width=40).read().bgr, expected)
    assert np.array_equal(FileSource(path, max_width=500).read().bgr, picture)


def test_equalisation_spreads_the_luminance(tmp_path: Path, picture: Bgr) -> None:
    path = save(tmp_path / "dark.png", picture // 4)
    plain = FileSource(path).read().bgr
    for how in ("histogram", "clahe"):
        assert FileSource(path, equalize=how).read().bgr.std() > 1.3 * plain.std()
    gray = save(tmp_path / "gray.png", picture[..., 0] // 4)
    bgr = FileSource(gray, equalize="clahe").read().bgr
    assert np.array_equal(bgr[..., 0], bgr[..., 2])


@pytest.mark.parametrize("settings", [{"max_width": 0}, {"equalize": "magic"}])
def test_senseless_settings_are_refused(tmp_path: Path, settings: dict[str, Any]) -> None:
    with pytest.raises(ArgumentError):
        FileSource(tmp_path / "a.png", **settings)


def test_content_key_follows_content_and_settings(tmp_path: Path, picture: Bgr) -> None:
    first, twin = (save(tmp_path / name, picture) for name in ("a.png", "b.png"))
    other = save(tmp_path / "c.png", picture // 2)
    key = FileSource(first).content_key()
    assert key == FileSource(twin).content_key()
    different = [
        FileSource(other),
        FileSource(first, max_width=40),
        FileSource(first, equalize="clahe"),
    ]
    assert len({key, *(source.content_key() for source in different)}) == 4


def test_a_source_hashes_once_and_its_copy_in_another_process_anew(
    tmp_path: Path, picture: Bgr
) -> None:
    source = FileSource(save(tmp_path / "a.png", picture), max_width=40)
    key = source.content_key()
    copy = pickle.loads(pickle.dumps(source))
    assert copy == source
    (tmp_path / "a.png").write_bytes(b"another file at the same path")
    assert source.content_key() == key
    assert copy.content_key() != key


def test_too_large_images_are_refused_or_decoded_smaller(tmp_path: Path, picture: Bgr) -> None:
    large = np.tile(picture, (4, 4, 1))
    jpeg = save(tmp_path / "large.jpg", large, quality=95)
    png = save(tmp_path / "large.png", large)
    limit = 20_000
    with pytest.raises(ImageError, match="`max_width=160`"):
        FileSource(jpeg, pixel_limit=limit).read()
    with pytest.raises(ImageError, match="tiles"):
        FileSource(png, max_width=40, pixel_limit=limit).read()
    reduced = FileSource(jpeg, max_width=80, pixel_limit=limit).read().bgr
    direct = FileSource(jpeg, max_width=80).read().bgr
    assert reduced.shape == direct.shape == (60, 80, 3)
    assert float(np.abs(reduced.astype(int) - direct).mean()) < 6


@pytest.mark.slow
def test_a_hundred_megapixels_work(tmp_path: Path) -> None:
    path = tmp_path / "survey.jpg"
    cv2.imwrite(str(path), np.full((8_000, 12_500, 3), 90, np.uint8))
    assert FileSource(path, max_width=1000).read().bgr.shape == (640, 1000, 3)
    assert FileSource(path).read().bgr.shape == (8_000, 12_500, 3)
