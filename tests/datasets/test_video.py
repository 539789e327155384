"""Frames of videos."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from aerocues.datasets.catalog import open_dataset
from aerocues.datasets.dataset import GpsPosition
from aerocues.datasets.video import parse_subtitles
from aerocues.errors import ArgumentError, DatasetError, ImageError

NEW = """1
00:00:00,000 --> 00:00:00,033
<font size="28">FrameCnt: 1, DiffTime: 33ms
2026-05-01 10:00:00.000
[iso: 100] [latitude: 46.100000] [longitude: 9.200000] [rel_alt: 30.000 abs_alt: 480.500] </font>

2
00:00:01,000 --> 00:00:01,033
[iso: 100] [latitude: 46.100100] [longitude: 9.200000] [rel_alt: 30.000 abs_alt: 481.000] </font>
"""
OLD = "1\r\n00:01:02,500 --> 00:01:03,500\r\nHOME(9.1,46.0)\r\nGPS(9.2,46.1,15) BAROMETER:30.1\r\n"


@pytest.fixture
def video(tmp_path: Path) -> Path:
    """Three seconds of a moving picture, ten frames a second."""
    path = tmp_path / "DJI_0001.MP4"
    size = (96, 64)
    noise = np.random.default_rng(0).integers(0, 256, (64, 300, 3)).astype(np.uint8)
    picture = np.asarray(cv2.GaussianBlur(noise, (0, 0), 3))
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"mp4v"), 10.0, size)
    if not writer.isOpened():
        pytest.skip("this build of OpenCV writes no videos")
    for frame in range(30):
        writer.write(np.ascontiguousarray(picture[:, 6 * frame : 6 * frame + 96]))
    writer.release()
    return path


def test_frames_are_taken_at_regular_times(video: Path) -> None:
    dataset = open_dataset(str(video))
    assert [image.name for image in dataset.images] == [
        f"DJI_0001_{frame:06d}.png" for frame in (0, 10, 20)
    ]
    assert (dataset.name, len(dataset.pairs)) == ("DJI_0001", 2)
    assert dataset.notes == ("3 frames of DJI_0001.MP4, one every 1 s",)
    capture = cv2.VideoCapture(str(video))
    frames = [capture.read()[1] for _ in range(30)]
    for image, expected in zip(dataset.images, frames[::10], strict=True):
        assert np.array_equal(image.read().bgr, expected)
    keys = [image.source.content_key() for image in dataset.images]
    assert len(set(keys)) == 3
    small = open_dataset(f"video:{video}", every=0.5, max_width=48)
    assert len(small.images) == 6
    assert small.images[1].read().bgr.shape == (32, 48, 3)
    assert dict(small.settings)["every"] == "0.5"
    assert small.source is not None
    again = open_dataset(small.source.spec, every=small.source.every)
    assert [image.name for image in again.images] == [image.name for image in small.images]


def test_subtitles_of_the_drone_give_positions(video: Path) -> None:
    video.with_suffix(".SRT").write_text(NEW)
    dataset = open_dataset(str(video))
    assert [image.gps for image in dataset.images] == [
        GpsPosition(46.1, 9.2, 480.5),
        GpsPosition(46.1001, 9.2, 481.0),
        GpsPosition(46.1001, 9.2, 481.0),
    ]
    assert dataset.notes[0].endswith("3 of them with GPS of its subtitles")
    assert parse_subtitles(OLD) == [(62.5, GpsPosition(46.1, 9.2))]
    assert parse_subtitles("no subtitles") == []


def test_what_is_no_video_is_told(video: Path, tmp_path: Path) -> None:
    (tmp_path / "broken.mp4").write_bytes(b"no video")
    with pytest.raises(DatasetError, match="ffmpeg"):
        open_dataset(str(tmp_path / "broken.mp4"))
    with pytest.raises(DatasetError, match="smaller `every`"):
        open_dataset(str(video), every="1min")
    with pytest.raises(ArgumentError):
        open_dataset(str(video), every="often")
    image = open_dataset(str(video)).images[2]
    video.write_bytes(b"gone")
    with pytest.raises(ImageError, match="frame 20"):
        image.read()
