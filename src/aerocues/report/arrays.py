"""Numbers for JSON: arrays in base64, other numbers rounded."""

from __future__ import annotations

import base64
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

DIGITS = 5
LARGEST_STEP = 65534


def packed_floats(values: ArrayLike) -> dict[str, str]:
    """Little-endian float32 in row-major order, as base64; NaN means no value."""
    return {"f32": _base64(np.asarray(values, dtype="<f4"))}


def packed_bytes(values: ArrayLike) -> dict[str, str]:
    """Unsigned bytes in row-major order, as base64."""
    return {"u8": _base64(np.asarray(values, dtype=np.uint8))}


def packed_scaled(values: ArrayLike, low: float, high: float) -> dict[str, str | float]:
    """Numbers between two bounds in 16 bits each, as base64; 65535 means no value.

    Values outside are clipped to the bounds.
    """
    numbers = np.asarray(values, dtype=np.float64)
    # Rounded first, because `plain` rounds them too.
    start, end = (float(f"{bound:.{DIGITS}g}") for bound in (low, high))
    steps = (np.clip(numbers, start, end) - start) / ((end - start) or 1.0) * LARGEST_STEP
    codes = np.where(np.isfinite(numbers), np.nan_to_num(steps).round(), LARGEST_STEP + 1)
    return {"u16": _base64(codes.astype("<u2")), "low": start, "high": end}


def _base64(values: np.ndarray[Any, Any]) -> str:
    return base64.b64encode(np.ascontiguousarray(values).tobytes()).decode("ascii")


def plain(value: Any) -> Any:
    """A value for JSON: five significant digits; null for NaN and infinity."""
    if value is None or isinstance(value, str | bool):
        return value
    if isinstance(value, np.generic | np.ndarray):
        return plain(value.tolist())
    if isinstance(value, int):
        return value
    if isinstance(value, float):
        return _rounded(value)
    if isinstance(value, Mapping):
        return {str(key): plain(each) for key, each in value.items()}
    if isinstance(value, list | tuple | set | frozenset):
        return [plain(each) for each in value]
    return value.as_posix() if isinstance(value, Path) else str(value)


def _rounded(value: float) -> float | int | None:
    if not math.isfinite(value):
        return None
    rounded = float(f"{value:.{DIGITS}g}")
    if not math.isfinite(rounded):
        return value  # rounding would exceed the largest number
    return int(rounded) if rounded == int(rounded) and abs(rounded) < 1e15 else rounded
