"""GPS positions from EXIF, and in metres in a local frame."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.dataset import GpsPosition

GPS_DIRECTORY = 0x8825
_LATITUDE_REF, _LATITUDE, _LONGITUDE_REF, _LONGITUDE, _ALTITUDE_REF, _ALTITUDE = range(1, 7)

SEMI_MAJOR_AXIS = 6_378_137.0
FLATTENING = 1 / 298.257223563


def position_from_tags(tags: Mapping[int, Any]) -> GpsPosition | None:
    """The position in a GPS directory of EXIF; None if there is no valid one.

    Latitude and longitude both exactly 0 mean that the receiver had no fix.
    """
    latitude = _degrees(tags.get(_LATITUDE), tags.get(_LATITUDE_REF), "S")
    longitude = _degrees(tags.get(_LONGITUDE), tags.get(_LONGITUDE_REF), "W")
    if latitude is None or longitude is None or (latitude == 0 and longitude == 0):
        return None
    if abs(latitude) > 90 or abs(longitude) > 180:
        return None
    return GpsPosition(latitude, longitude, _altitude(tags))


def _degrees(value: Any, reference: Any, negative: str) -> float | None:
    parts = [_number(part) for part in value] if isinstance(value, tuple | list) else []
    if not 1 <= len(parts) <= 3 or any(part is None for part in parts):
        return None
    degrees = sum(part / float(60**power) for power, part in enumerate(parts) if part is not None)
    south_or_west = str(reference or "").strip("\x00 ").upper() == negative
    return -degrees if south_or_west else degrees


def _altitude(tags: Mapping[int, Any]) -> float | None:
    altitude = _number(tags.get(_ALTITUDE))
    below_sea = tags.get(_ALTITUDE_REF) in (1, b"\x01")
    return -altitude if altitude is not None and below_sea else altitude


def _number(value: Any) -> float | None:
    try:
        number = float(value)
    except (TypeError, ValueError, ZeroDivisionError):
        return None
    return number if math.isfinite(number) else None


def east_north_up(
    positions: Sequence[GpsPosition], origin: GpsPosition | None = None
) -> NDArray[np.float64]:
    """Positions in metres east, north and up of an origin.

    Parameters
    ----------
    positions : sequence of GpsPosition
        A missing altitude counts as the origin's, else as the median of the others.
    origin : GpsPosition, optional
        By default the first position.

    Returns
    -------
    (N, 3) float64
        Exact on the WGS84 ellipsoid, by earth-centred coordinates and a rotation.
    """
    if not positions:
        return np.empty((0, 3))
    origin = positions[0] if origin is None else origin
    ground = _ground(positions, origin)
    earth_centred = np.array([_earth_centred(position, ground) for position in positions])
    latitude, longitude = math.radians(origin.latitude), math.radians(origin.longitude)
    sin_lat, cos_lat = math.sin(latitude), math.cos(latitude)
    sin_lon, cos_lon = math.sin(longitude), math.cos(longitude)
    axes = np.array(
        [
            [-sin_lon, cos_lon, 0.0],
            [-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat],
            [cos_lat * cos_lon, cos_lat * sin_lon, sin_lat],
        ]
    )
    local: NDArray[np.float64] = (earth_centred - _earth_centred(origin, ground)) @ axes.T
    return local


def _ground(positions: Sequence[GpsPosition], origin: GpsPosition) -> float:
    if origin.altitude is not None:
        return origin.altitude
    known = [each.altitude for each in positions if each.altitude is not None]
    return float(np.median(known)) if known else 0.0


def _earth_centred(position: GpsPosition, ground: float) -> NDArray[np.float64]:
    latitude, longitude = math.radians(position.latitude), math.radians(position.longitude)
    height = ground if position.altitude is None else position.altitude
    eccentricity = FLATTENING * (2 - FLATTENING)
    normal = SEMI_MAJOR_AXIS / math.sqrt(1 - eccentricity * math.sin(latitude) ** 2)
    return np.array(
        [
            (normal + height) * math.cos(latitude) * math.cos(longitude),
            (normal + height) * math.cos(latitude) * math.sin(longitude),
            (normal * (1 - eccentricity) + height) * math.sin(latitude),
        ]
    )
