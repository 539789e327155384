"""One image and its transformations with exact homographies: one row each."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import cache, cached_property
from importlib.resources import files
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from aerocues.datasets import geometry, photometry
from aerocues.datasets.dataset import Dataset, Image, ImageSource, Pair, Pixels
from aerocues.datasets.decoding import FileSource
from aerocues.datasets.fitting import equalize_luminance, fitted_size, shrink
from aerocues.datasets.options import Options
from aerocues.errors import DatasetError

ORIGINAL = "original"
RECIPE_VERSION = "1"
"""Part of content keys; increased when a transformation gives other pixels."""


@dataclass(frozen=True)
class Transformation:
    """One row of the table.

    Parameters
    ----------
    sequence : str
        Name of the group of rows.
    kind : str
        A key of `geometry.WARPS` or `photometry.CHANGES`.
    value : float
        Degrees, factor, gray levels, pixels or quality, depending on the kind.
    text : str
        Format of the value in the image's name.
    """

    sequence: str
    kind: str
    value: float
    text: str

    @property
    def name(self) -> str:
        """Name of the transformed image, such as ``rotation_015``."""
        return f"{self.kind}_{self.value:{self.text}}"


def _rows(sequence: str, kind: str, text: str, *values: float) -> tuple[Transformation, ...]:
    return tuple(Transformation(sequence, kind, value, text) for value in values)


STANDARD: tuple[Transformation, ...] = (
    *_rows("rotation", "rotation", "03.0f", 15, 30, 45, 60, 75, 90),
    *_rows("scale", "scale", ".2f", 0.5, 0.7, 0.9, 1.1, 1.3, 1.5),
    *_rows("intensity", "intensity_add", "+03.0f", -30, -10, 10, 30),
    *_rows("intensity", "intensity_mul", ".2f", 0.7, 0.9, 1.1, 1.3),
)
EXTENDED: tuple[Transformation, ...] = (
    *STANDARD[:6],
    *_rows("rotation", "rotation", "03.0f", 105, 120, 135, 150, 165, 180),
    *STANDARD[6:],
    *_rows("contrast", "contrast", ".2f", 0.4, 0.7, 1.5, 2.0),
    *_rows("noise", "noise", "02.0f", 5, 10, 20, 30),
    *_rows("blur", "blur", ".1f", 1, 2, 3, 4),
    *_rows("jpeg", "jpeg", "02.0f", 50, 25, 10, 5),
    *_rows("tilt", "tilt", "02.0f", 20, 30, 40, 50, 60),
)
SETS = {"synthetic": STANDARD, "synthetic-extended": EXTENDED}
_ROWS = {row.name: row for row in EXTENDED}


@cache
def _town() -> NDArray[np.uint8]:
    """(665, 1000, 3) BGR pixels of the picture in the package, read-only."""
    data = files("aerocues.datasets").joinpath("town.png").read_bytes()
    bgr: Any = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR)
    bgr.flags.writeable = False
    return np.asarray(bgr)


@dataclass(frozen=True)
class TownSource:
    """The picture of a town that comes with the package."""

    max_width: int | None = None
    equalize: str = "none"

    def read(self) -> Pixels:
        """The image at its final size; all pixels are valid."""
        pixels = shrink(Pixels(_town().copy()), self.max_width)
        return equalize_luminance(pixels, self.equalize)

    def size(self) -> tuple[int, int]:
        """Width and height of the image that `read` returns."""
        height, width = _town().shape[:2]
        return fitted_size((width, height), self.max_width)

    def is_gray(self) -> bool:
        """False."""
        return False

    def content_key(self) -> str:
        """Hash of the pixels and of the settings."""
        return self._content_key

    @cached_property
    def _content_key(self) -> str:
        digest = hashlib.sha256(_town().tobytes())
        digest.update(f"|{self.max_width}|{self.equalize}".encode())
        return digest.hexdigest()


@dataclass(frozen=True)
class TransformedSource:
    """A transformation of another source, computed when it is read.

    Parameters
    ----------
    original : TownSource or FileSource
        Not equalised: illumination is normalised last, as for a photograph.
    transformation : str
        Name of a row of `EXTENDED`.
    equalize : str
        ``none``, ``histogram`` or ``clahe``.
    """

    original: TownSource | FileSource
    transformation: str
    equalize: str = "none"

    def read(self) -> Pixels:
        """The transformed image; ImageError if the original cannot be decoded."""
        row, pixels = _ROWS[self.transformation], self.original.read()
        if row.kind in geometry.WARPS:
            changed = geometry.warp(pixels, row.kind, row.value)
        else:
            change = photometry.CHANGES[row.kind]
            changed = Pixels(change(pixels.bgr, row.value, self.is_gray()), pixels.valid)
        return equalize_luminance(changed, self.equalize)

    def is_gray(self) -> bool:
        """Whether the original has a single channel."""
        return self.original.is_gray()

    def content_key(self) -> str:
        """Hash of the original's key and of the transformation."""
        recipe = f"{RECIPE_VERSION}|{_ROWS[self.transformation]}|{self.equalize}"
        return hashlib.sha256(f"{self.original.content_key()}|{recipe}".encode()).hexdigest()


def open_synthetic(image: Path | None, options: Options, kind: str = "synthetic") -> Dataset:
    """Pairs of the original with each of its transformations.

    Parameters
    ----------
    image : Path or None
        The original; the picture of a town in the package by default.
    options : Options
        `max_width` is the width of the original.
    kind : str
        ``synthetic`` (20 pairs) or ``synthetic-extended``.

    Raises
    ------
    DatasetError
        If the image is missing or its header cannot be read.
    """
    plain = _source(image, options, "none")
    size = plain.size()
    images = [Image(ORIGINAL, _source(image, options, options.equalize))]
    pairs = []
    for index, row in enumerate(SETS[kind]):
        source: ImageSource = TransformedSource(plain, row.name, options.equalize)
        images.append(Image(row.name, source))
        matrix = np.eye(3)
        if row.kind in geometry.WARPS:
            matrix, _ = geometry.placement(row.kind, row.value, size)
        pairs.append(Pair(index, ORIGINAL, row.name, row.sequence, matrix))
    settings = options.settings(
        pairs="original with each other", source="drawn" if image is None else image.name
    )
    return Dataset(kind, images, pairs, "homography", settings)


def _source(image: Path | None, options: Options, equalize: str) -> TownSource | FileSource:
    if image is None:
        return TownSource(options.max_width, equalize)
    if image.is_dir():
        raise DatasetError(f"{image} is a folder; give one image: synthetic:IMAGE")
    return FileSource(image.absolute(), options.max_width, equalize, band=options.band)
