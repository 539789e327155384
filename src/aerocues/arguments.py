"""Checks of arguments, the same for functions and commands: what is wrong is told in one form."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from numbers import Integral, Real

from aerocues.errors import ArgumentError

SECONDS = {"": 1.0, "ms": 0.001, "s": 1.0, "sec": 1.0, "min": 60.0, "m": 60.0, "h": 3600.0}
MEGABYTES = {"": 1.0, "mb": 1.0, "gb": 1000.0}


def check_choice(parameter: str, value: object, choices: Iterable[str]) -> None:
    """Raise ArgumentError unless a value is one of some texts."""
    known = tuple(choices)
    if value not in known:
        raise ArgumentError(f"`{parameter}` must be one of {', '.join(known)}, got {value!r}")


def check_whole(parameter: str, value: object, least: int) -> None:
    """Raise ArgumentError unless a value is a whole number, `least` or more."""
    if isinstance(value, bool) or not isinstance(value, Integral) or value < least:
        raise ArgumentError(f"`{parameter}` must be a whole number, {least} or more, got {value!r}")


def check_number(parameter: str, value: object, low: float, high: float = math.inf) -> None:
    """Raise ArgumentError unless a value is a finite number from `low` to `high`."""
    number = _number(value)
    if not low <= number <= high or math.isinf(number):
        limits = f"from {low:g} to {high:g}" if math.isfinite(high) else f"of {low:g} or more"
        raise ArgumentError(f"`{parameter}` must be a number {limits}, got {value!r}")


def check_positive(parameter: str, value: object) -> None:
    """Raise ArgumentError unless a value is a finite number above 0."""
    if not 0 < _number(value) < math.inf:
        raise ArgumentError(f"`{parameter}` must be a number above 0, got {value!r}")


def seconds_of(parameter: str, value: str | float) -> float:
    """Seconds above 0, from a number or a text such as ``90s``, ``5min`` or ``1.5 h``.

    Raises
    ------
    ArgumentError
        If it is neither.
    """
    seconds = _in_units(value, SECONDS)
    if not 0 < seconds < math.inf:
        raise ArgumentError(
            f"`{parameter}` must be a time above 0, such as 90s, 5min or 1h, got {value!r}"
        )
    return seconds


def megabytes_of(parameter: str, value: str | float) -> float:
    """Megabytes above 0, from a number of them or a text such as ``300MB`` or ``1.5 GB``.

    Raises
    ------
    ArgumentError
        If it is neither.
    """
    megabytes = _in_units(value, MEGABYTES)
    if not 0 < megabytes < math.inf:
        raise ArgumentError(
            f"`{parameter}` must be a size above 0, such as 300MB or 1.5GB, got {value!r}"
        )
    return megabytes


def _in_units(value: str | float, units: Mapping[str, float]) -> float:
    """A number, or a text of a number and a unit; 0 or NaN where it is neither."""
    if not isinstance(value, str):
        return _number(value)
    match = re.fullmatch(r"\s*(\d+(?:\.\d+)?)\s*([a-z]*)\s*", value.lower())
    return float(match[1]) * units[match[2]] if match and match[2] in units else 0.0


def _number(value: object) -> float:
    """A number as it is; NaN for anything else."""
    return float(value) if isinstance(value, Real) and not isinstance(value, bool) else math.nan
