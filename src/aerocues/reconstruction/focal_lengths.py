"""Focal lengths from EXIF: which can be right, and which an image takes from others."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from aerocues.datasets.decoding import FileSource
from aerocues.reconstruction.prepared import Prepared

SHORTEST, LONGEST = 0.2, 50.0
"""Of the longer side of the image: a fisheye lens, and a telescope."""
SAME = 0.01
"""Relative difference within which focal lengths are those of one camera."""


def exif_focal_length(source: FileSource, longer_side: int) -> float | None:
    """The focal length that COLMAP reads from EXIF, scaled to the measured size, in pixels.

    None where EXIF has none or one that cannot be right, such as a fraction with denominator 0.
    """
    import pycolmap

    try:
        camera = pycolmap.infer_camera_from_image(str(source.path))
    except (ValueError, RuntimeError):
        return None  # COLMAP reads no focal length from unknown formats
    if not camera.has_prior_focal_length:
        return None
    share = float(camera.mean_focal_length()) / max(camera.width, camera.height)
    return share * longer_side if math.isfinite(share) and SHORTEST <= share <= LONGEST else None


def with_those_of_others(prepared: Sequence[Prepared]) -> tuple[list[Prepared], list[str]]:
    """Images without a focal length take that of the others of their size, if it is one.

    Parameters
    ----------
    prepared : sequence of Prepared

    Returns
    -------
    list of Prepared
    list of str
        Names of the images that took it.
    """
    by_size: dict[tuple[int, ...], list[float]] = {}
    for each in prepared:
        if each.focal_length is not None:
            by_size.setdefault(_size(each), []).append(each.focal_length)
    found, names = [], []
    for each in prepared:
        known = by_size.get(_size(each), [])
        if each.focal_length is None and known and max(known) <= (1 + SAME) * min(known):
            names.append(each.name)
            found.append(replace(each, focal_length=max(known, key=known.count)))
        else:
            found.append(each)
    return found, names


def _size(image: Prepared) -> tuple[int, ...]:
    """Regardless of whether the camera was held upright."""
    return tuple(sorted((image.width, image.height)))


def told_taken(names: Sequence[str], prepared: Sequence[Prepared]) -> str:
    """``focal length: 1 of 6 images takes that of the others from EXIF (249.9 px): a``."""
    lengths = {each.name: each.focal_length for each in prepared}
    shown = ", ".join(names[:3]) + (", ..." if len(names) > 3 else "")
    takes = "takes" if len(names) == 1 else "take"
    return (
        f"focal length: {len(names)} of {len(prepared)} images {takes} that of the others from "
        f"EXIF ({lengths[names[0]]:.1f} px): {shown}"
    )
