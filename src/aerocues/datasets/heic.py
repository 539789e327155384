"""HEIC files, which phones write; read where pillow-heif is installed."""

from __future__ import annotations

from importlib.util import find_spec
from io import BytesIO
from typing import Any

import numpy as np
from numpy.typing import NDArray

SUFFIXES = frozenset({".heic", ".heif", ".hif"})
BRANDS = frozenset({b"heic", b"heix", b"hevc", b"heim", b"heis", b"mif1", b"msf1"})
PACKAGE = "pillow_heif"
INSTALL = "install pillow-heif (pip install 'aerocues[heic]'), or convert them to JPEG"


def can_read_heic() -> bool:
    """Whether pillow-heif is installed."""
    return find_spec(PACKAGE) is not None


def open_heic(data: bytes) -> Any:
    """The main image of a file, as pillow-heif describes it, upright; not decoded yet.

    Raises
    ------
    ImportError
        If pillow-heif is not installed.
    """
    from pillow_heif import open_heif

    return open_heif(BytesIO(data), convert_hdr_to_8bit=True, bgr_mode=True)


def decode_heic(data: bytes) -> NDArray[np.uint8]:
    """The pixels of a file, (H, W, 3 or 4): blue, green, red and alpha; 10 bits become 8."""
    return np.ascontiguousarray(np.asarray(open_heic(data)), np.uint8)
