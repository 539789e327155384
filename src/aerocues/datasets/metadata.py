"""What image files say of themselves: size, place, camera and time."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Any

from aerocues.datasets.dataset import GpsPosition
from aerocues.datasets.gps import GPS_DIRECTORY, position_from_tags
from aerocues.datasets.header import read_tags
from aerocues.datasets.yaw import yaw_of
from aerocues.errors import ImageError
from aerocues.phrases import printable

MAKE, MODEL, TIME = 271, 272, 306
_EXIF_DIRECTORY, _ORIGINAL_TIME = 0x8769, 36867


@dataclass(frozen=True)
class Metadata:
    """What is known of an image without decoding it; None or empty where it is not.

    Parameters
    ----------
    size : tuple of int or None
        Width and height, upright.
    gps : GpsPosition or None
    camera : str
        Make and model.
    taken : datetime or None
    yaw : float or None
        See `yaw_of`.
    """

    size: tuple[int, int] | None = None
    gps: GpsPosition | None = None
    camera: str = ""
    taken: datetime | None = None
    yaw: float | None = None


def read_metadata(path: Path) -> Metadata:
    """The metadata of a file; nothing of one that cannot be read."""
    try:
        header, tags = read_tags(path, (GPS_DIRECTORY, _EXIF_DIRECTORY))
    except ImageError:
        return Metadata()
    main, gps, exif = tags[0], tags[GPS_DIRECTORY], tags[_EXIF_DIRECTORY]
    camera = " ".join(filter(None, (_text(main.get(tag)) for tag in (MAKE, MODEL))))
    taken = _time(exif.get(_ORIGINAL_TIME)) or _time(main.get(TIME))
    return Metadata(header.size, position_from_tags(gps), camera, taken, yaw_of(header.xmp))


def _text(value: Any) -> str:
    return printable(value.strip("\x00 ")) if isinstance(value, str) else ""


def _time(value: Any) -> datetime | None:
    try:
        return datetime.strptime(str(value).strip("\x00 "), "%Y:%m:%d %H:%M:%S")
    except ValueError:
        return None
