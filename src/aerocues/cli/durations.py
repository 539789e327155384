"""Times as people write them: ``5min``, ``90 s``, ``1.5h``."""

from __future__ import annotations

import re

from aerocues.errors import SelectionError

SECONDS = {"": 1.0, "s": 1.0, "sec": 1.0, "min": 60.0, "m": 60.0, "h": 3600.0}


def parse_duration(text: str, option: str) -> float:
    """Seconds of a time.

    Raises
    ------
    SelectionError
        If it is none, or not above 0.
    """
    match = re.fullmatch(r"\s*(\d+(?:\.\d+)?)\s*([a-z]*)\s*", text.lower())
    if match is None or match[2] not in SECONDS or float(match[1]) <= 0:
        raise SelectionError(f"{option} {text} is no time; give it such as 90s, 5min or 1h")
    return float(match[1]) * SECONDS[match[2]]
