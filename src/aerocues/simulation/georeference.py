"""Georeference of a simulated world."""

from __future__ import annotations

import math

import numpy as np

from aerocues.datasets.dataset import GpsPosition
from aerocues.datasets.gps import FLATTENING, SEMI_MAJOR_AXIS

ORIGIN = GpsPosition(47.641468, -122.140165, 122.0)
"""WGS84 position of the world's origin; AirSim's by default."""


def geodetic(north: float, east: float, down: float, origin: GpsPosition = ORIGIN) -> GpsPosition:
    """WGS84 position of a point of the world, whose axes span the tangent plane."""
    latitude, longitude = math.radians(origin.latitude), math.radians(origin.longitude)
    eccentricity = FLATTENING * (2 - FLATTENING)
    sin_lat, cos_lat = math.sin(latitude), math.cos(latitude)
    normal = SEMI_MAJOR_AXIS / math.sqrt(1 - eccentricity * sin_lat**2)
    height = origin.altitude or 0.0
    up = -down
    # In the plane of the origin's meridian: away from the axis, east, and along the axis.
    away = (normal + height) * cos_lat - north * sin_lat + up * cos_lat
    along = (normal * (1 - eccentricity) + height) * sin_lat + north * cos_lat + up * sin_lat
    distance = math.hypot(away, east)
    found = math.atan2(along, distance * (1 - eccentricity))
    for _ in range(6):  # converges to below a micrometre in three steps
        normal = SEMI_MAJOR_AXIS / math.sqrt(1 - eccentricity * math.sin(found) ** 2)
        found = math.atan2(along + eccentricity * normal * math.sin(found), distance)
    altitude = distance / math.cos(found) - normal
    turned = longitude + math.atan2(east, away)
    return GpsPosition(math.degrees(found), math.degrees(turned), float(np.round(altitude, 6)))
