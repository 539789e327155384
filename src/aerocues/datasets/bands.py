"""Bands of one exposure in files of their own, as multispectral cameras write them."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path

from aerocues.datasets.header import read_header
from aerocues.errors import DatasetError, ImageError

_BAND = re.compile(
    r"(?P<exposure>.+)_(?P<band>\d{1,2}|blue|green|red|nir|red_?edge|lwir|gre|reg|b|g|r|re|n)",
    re.IGNORECASE,
)
_SUFFIXES = frozenset({".tif", ".tiff"})
FEWEST_EXPOSURES = 2
COMPLETE = 0.8
"""Least share of the exposures that have all bands."""


def by_band(paths: Sequence[Path]) -> dict[str, list[Path]]:
    """Files by their band, in order; empty unless they are gray files of several bands.

    Names are those of MicaSense (``IMG_0001_1.tif`` to ``_5``), Parrot (``_GRE``, ``_NIR``) and
    DJI (``_MS_G``, ``_MS_NIR``).
    """
    bands: dict[str, dict[Path, Path]] = {}
    for path in paths:
        found = _BAND.fullmatch(path.stem)
        if found is not None and path.suffix.lower() in _SUFFIXES:
            exposure = path.with_name(found["exposure"])
            bands.setdefault(found["band"].upper(), {})[exposure] = path
    exposures = {exposure for own in bands.values() for exposure in own}
    if len(bands) < 2 or len(exposures) < FEWEST_EXPOSURES:
        return {}
    whole = [each for each in exposures if all(each in own for own in bands.values())]
    if len(whole) < COMPLETE * len(exposures) or not _is_gray(next(iter(bands.values()))[whole[0]]):
        return {}
    return {label: list(bands[label].values()) for label in sorted(bands, key=_order)}


def _order(label: str) -> tuple[int, str]:
    return (int(label), "") if label.isdigit() else (0, label)


def _is_gray(path: Path) -> bool:
    try:
        return read_header(path, str(path)).gray
    except ImageError:
        return False


def files_of_band(paths: Sequence[Path], band: int | None, folder: Path) -> list[Path]:
    """The files of the chosen band; all of them where bands are no files of their own.

    Raises
    ------
    DatasetError
        If a band must be chosen, or the chosen one is not there.
    """
    bands = by_band(paths)
    if not bands:
        return list(paths)
    labels = list(bands)
    if band is None or not 1 <= band <= len(labels):
        raise DatasetError(
            f"the images of {folder} are {len(labels)} bands of each exposure, in files of their "
            f"own ({_numbered(bands)}); choose one with `band`, from 1 to {len(labels)}, or "
            "other images with `subset`"
        )
    return bands[labels[band - 1]]


def _numbered(bands: Mapping[str, Sequence[Path]]) -> str:
    named = [f"{number}: {files[0].name}" for number, files in enumerate(bands.values(), start=1)]
    return ", ".join(named)
