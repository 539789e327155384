"""Small images for the page."""

from __future__ import annotations

import base64
import io
from dataclasses import asdict, dataclass
from typing import Any

from aerocues.datasets.dataset import Image

WIDTH = 700
QUALITY = 72


@dataclass(frozen=True)
class Thumbnail:
    """A small image.

    Attributes
    ----------
    src : str
        A data URL.
    width, height : int
        Pixels.
    scale : float
        Its pixels per pixel of the measured image.
    """

    src: str
    width: int
    height: int
    scale: float

    def facts(self) -> dict[str, Any]:
        """Its form in the payload."""
        return asdict(self)


def thumbnail(image: Image, most: int = WIDTH) -> Thumbnail:
    """The image as measured (size, equalisation), shrunk to at most this width and compressed.

    Raises
    ------
    ImageError
        If the image cannot be read.
    """
    from PIL import Image as Pillow

    bgr = image.read().bgr
    height, width = bgr.shape[:2]
    scale = min(1.0, most / width)
    size = (max(1, round(width * scale)), max(1, round(height * scale)))
    picture = Pillow.fromarray(bgr[:, :, ::-1]).resize(size, Pillow.Resampling.LANCZOS)
    content = io.BytesIO()
    picture.save(content, "WEBP", quality=QUALITY)
    text = base64.b64encode(content.getvalue()).decode("ascii")
    return Thumbnail(f"data:image/webp;base64,{text}", *size, scale)
