"""Reads back what the report has packed."""

from __future__ import annotations

import base64
import json
import re
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

PAYLOAD = re.compile(r'<script type="application/json" id="payload">(.*?)</script>', re.DOTALL)


def floats(packed: dict[str, str], *shape: int) -> NDArray[np.float32]:
    """An array of float32."""
    return np.frombuffer(base64.b64decode(packed["f32"]), "<f4").reshape(shape)


def numbers(packed: dict[str, str], *shape: int) -> NDArray[np.uint8]:
    """An array of bytes."""
    return np.frombuffer(base64.b64decode(packed["u8"]), np.uint8).reshape(shape)


def scaled(packed: dict[str, Any]) -> NDArray[np.float64]:
    """Numbers of 16 bits between two bounds; NaN where there is none."""
    codes = np.frombuffer(base64.b64decode(packed["u16"]), "<u2")
    values = packed["low"] + codes / 65534 * (packed["high"] - packed["low"])
    return np.where(codes == 65535, np.nan, values)


def payload_in(page: Path) -> dict[str, Any]:
    """The payload of a page."""
    found = PAYLOAD.findall(page.read_text(encoding="utf-8"))
    assert len(found) == 1
    read: dict[str, Any] = json.loads(found[0])
    return read
