"""An image that is in memory already."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.dataset import Pixels
from aerocues.errors import ImageError


@dataclass(frozen=True, eq=False)
class DecodedSource:
    """Pixels as the source of an image.

    Parameters
    ----------
    pixels : Pixels
    """

    pixels: Pixels

    def read(self) -> Pixels:
        return self.pixels

    def content_key(self) -> str:
        """Hash of the pixels and of which of them are valid."""
        bgr, valid = self.pixels.bgr, self.pixels.valid
        content = hashlib.sha256(str(bgr.shape).encode() + bgr.tobytes())
        if valid is not None:
            content.update(valid.tobytes())
        return content.hexdigest()

    def is_gray(self) -> bool:
        """Whether the three channels are the same."""
        bgr = self.pixels.bgr
        return bool((bgr == bgr[..., :1]).all())


def pixels_of(array: NDArray[np.uint8]) -> Pixels:
    """The pixels of an array.

    Parameters
    ----------
    array : (H, W, 3) uint8
        Blue, green, red; or (H, W) gray.

    Raises
    ------
    ImageError
        If the shape or the type is another one.
    """
    if not isinstance(array, np.ndarray):
        raise ImageError(f"an image is a path or an array, got {array!r}")
    if (
        array.dtype != np.uint8
        or not (array.ndim == 2 or array.shape[2:] == (3,))
        or not array.size
    ):
        raise ImageError(
            f"an image is an array of uint8 of shape (H, W, 3) or (H, W), got {array.dtype} of "
            f"shape {array.shape}; convert it first"
        )
    bgr = array if array.ndim == 3 else np.repeat(array[..., np.newaxis], 3, axis=2)
    return Pixels(np.ascontiguousarray(bgr))
