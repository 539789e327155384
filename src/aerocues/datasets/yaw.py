"""Which way a camera faced, as drones write it into the XMP of their images."""

from __future__ import annotations

import re

# As attributes or elements, under the prefixes of DJI, Parrot, senseFly, Autel and others.
_WRITTEN = r"""\b[\w-]+:{name}\s*(?:=\s*["']|>)\s*([+-]?\d{{1,6}}(?:\.\d{{0,9}})?)\s*["'<]"""
_NAMES = ("GimbalYawDegree", "GimbalYaw", "Yaw", "FlightYawDegree")
"""The camera's own yaw before that of the drone."""
TURN = 360.0


def yaw_of(xmp: bytes | str | None) -> float | None:
    """Degrees clockwise from north to the top of a nadir image; None where XMP tells nothing.

    Parameters
    ----------
    xmp : bytes, str or None
        The XMP packet of an image file.
    """
    values = (written_number(xmp, name) for name in _NAMES)
    return next((value for value in values if value is not None and abs(value) <= TURN), None)


def written_number(xmp: bytes | str | None, name: str) -> float | None:
    """The number of a field of an XMP packet, whatever its prefix; None where there is none."""
    text = xmp.decode(errors="replace") if isinstance(xmp, bytes) else xmp or ""
    found = re.search(_WRITTEN.format(name=name), text)
    return float(found[1]) if found else None
