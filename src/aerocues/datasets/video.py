"""Frames of a video as images, with GPS from the subtitles that drones write beside it."""

from __future__ import annotations

import hashlib
import re
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from aerocues.datasets.dataset import Dataset, GpsPosition, Image, Pixels
from aerocues.datasets.fitting import check_settings, equalize_luminance, shrink
from aerocues.datasets.folder import chosen_pairs, scene_of
from aerocues.datasets.options import Options
from aerocues.errors import DatasetError, ImageError
from aerocues.phrases import count, printable

EVERY = 1.0
"""Seconds between two frames, by default."""
_CUE = re.compile(r"(\d+):(\d+):(\d+)[,.](\d+)\s*-->")
_NUMBER = r"\s*:?\s*(-?\d+(?:\.\d+)?)"
_LATITUDE, _LONGITUDE = (re.compile(rf"{name}{_NUMBER}") for name in ("latitude", "longitude"))
_ALTITUDE = re.compile(rf"abs_alt{_NUMBER}")
# Older drones: longitude, latitude and a number of satellites or a height.
_OLD = re.compile(r"GPS\s*\((-?\d+(?:\.\d+)?),\s*(-?\d+(?:\.\d+)?),")


@dataclass(frozen=True)
class FrameSource:
    """A frame of a video.

    Parameters
    ----------
    path : Path
    frame : int
        From 0 on.
    max_width, equalize
        As those of `FileSource`.
    """

    path: Path
    frame: int
    max_width: int | None = None
    equalize: str = "none"

    def __post_init__(self) -> None:
        check_settings(self.max_width, self.equalize)

    def read(self) -> Pixels:
        """Decode the frame; ImageError if it is not there."""
        capture: Any = cv2.VideoCapture(str(self.path))
        try:
            capture.set(cv2.CAP_PROP_POS_FRAMES, self.frame)
            found, bgr = capture.read()
        finally:
            capture.release()
        if not found:
            raise ImageError(
                f"frame {self.frame} of {printable(str(self.path))} cannot be decoded; copy the "
                "video again"
            )
        pixels = Pixels(np.ascontiguousarray(bgr, np.uint8))
        return equalize_luminance(shrink(pixels, self.max_width), self.equalize)

    def content_key(self) -> str:
        """Hash of the pixels."""
        return hashlib.sha256(self.read().bgr.tobytes()).hexdigest()

    def is_gray(self) -> bool:
        """Decoders give colours."""
        return False


def open_video(path: Path, options: Options) -> Dataset:
    """Frames of a video at regular times; consecutive ones are pairs by default.

    Raises
    ------
    DatasetError
        If it cannot be read, or gives fewer than two frames.
    """
    rate, frames = _facts(path)
    step = max(round((options.every or EVERY) * rate), 1)
    positions = _positions(path)
    images = [
        Image(
            f"{path.stem}_{number:06d}.png",
            FrameSource(path.absolute(), number, options.max_width, options.equalize),
            _nearest(positions, number / rate, step / rate),
        )
        for number in range(0, frames, step)
    ]
    images = [image for image in images if options.takes(image.name)]
    if len(images) < 2:
        raise DatasetError(
            f"{path} lasts {frames / rate:.1f} s and gives {count(len(images), 'frame')}; give a "
            "smaller `every`"
        )
    strategy, text = chosen_pairs(options)
    settings = options.settings(pairs=text, every=f"{step / rate:g}")
    located = sum(image.gps is not None for image in images)
    told = f"{count(len(images), 'frame')} of {path.name}, one every {step / rate:g} s"
    told += f", {located} of them with GPS of its subtitles" if located else ""
    return replace(
        scene_of(path.with_suffix(""), images, strategy.pairs(images), settings), notes=(told,)
    )


def _facts(path: Path) -> tuple[float, int]:
    """Frames per second, and how many there are."""
    capture: Any = cv2.VideoCapture(str(path))
    try:
        rate = float(capture.get(cv2.CAP_PROP_FPS))
        frames = int(capture.get(cv2.CAP_PROP_FRAME_COUNT))
    finally:
        capture.release()
    if not 0 < rate < 1000 or frames < 1:
        raise DatasetError(
            f"OpenCV cannot read the video {printable(str(path))}; save frames of it, and give "
            f"their folder: ffmpeg -i {printable(str(path))} -vf fps=1 frames/%05d.jpg"
        )
    return rate, frames


def _positions(video: Path) -> list[tuple[float, GpsPosition]]:
    """Seconds and positions in the subtitles beside a video, in order; empty without any."""
    for suffix in (".SRT", ".srt"):
        try:
            text = video.with_suffix(suffix).read_text(encoding="utf-8", errors="replace")
        except OSError:
            continue
        return parse_subtitles(text)
    return []


def parse_subtitles(text: str) -> list[tuple[float, GpsPosition]]:
    """Seconds and GPS positions in subtitles as DJI writes them.

    Parameters
    ----------
    text : str
        Such as ``[latitude: 46.1] [longitude: 9.2] [rel_alt: 30.0 abs_alt: 480.1]``, or
        ``GPS(9.2,46.1,15)`` of older drones.
    """
    found = []
    for block in re.split(r"\n\s*\n", text.replace("\r\n", "\n")):
        cue = _CUE.search(block)
        position = _position(block)
        if cue and position:
            hours, minutes, seconds, thousandths = map(int, cue.groups())
            at = 3600 * hours + 60 * minutes + seconds + thousandths / 1000
            found.append((float(at), position))
    return sorted(found, key=lambda each: each[0])


def _position(block: str) -> GpsPosition | None:
    altitude = _ALTITUDE.search(block)
    height = float(altitude[1]) if altitude else None
    latitude, longitude = _LATITUDE.search(block), _LONGITUDE.search(block)
    if latitude and longitude:
        place = float(latitude[1]), float(longitude[1])
    elif old := _OLD.search(block):
        place = float(old[2]), float(old[1])
    else:
        return None
    if place == (0.0, 0.0) or abs(place[0]) > 90 or abs(place[1]) > 180:
        return None
    return GpsPosition(*place, height)


def _nearest(
    positions: list[tuple[float, GpsPosition]], at: float, within: float
) -> GpsPosition | None:
    near = min(positions, key=lambda each: abs(each[0] - at), default=None)
    return near[1] if near is not None and abs(near[0] - at) <= within else None
