"""Opens a scene: pairs by GPS if most images have it, else all pairs."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path

from aerocues.datasets.catalog import open_dataset
from aerocues.datasets.dataset import Dataset
from aerocues.datasets.usable_gps import UsableGps

EVERY_PAIR = "exhaustive"
NEIGHBOURS = "gps"


def open_scene(
    spec: str | Path | Sequence[str | Path],
    *,
    pairs: str | None = None,
    max_width: int | None = None,
    equalize: str = "none",
    sequences: str | Sequence[str] | None = None,
    subset: str | None = None,
    band: int | None = None,
    every: float | str | None = None,
) -> Dataset:
    """Open a dataset to reconstruct it.

    Consecutive pairs do not join the strips of a survey. By default images are matched with their
    GPS neighbours, or with all other images if fewer than half of the positions can be used.

    Parameters
    ----------
    spec, pairs, max_width, equalize, sequences, subset, band, every
        As in `aerocues.open_dataset`.

    Raises
    ------
    DatasetError
        If the dataset cannot be opened.
    """
    opened = partial(
        open_dataset,
        spec,
        max_width=max_width,
        equalize=equalize,
        sequences=sequences,
        subset=subset,
        band=band,
        every=every,
    )
    scene = opened(pairs=pairs)
    if pairs is not None or not _has_choice(scene):
        return scene
    located = UsableGps.of([image.gps for image in scene.images]).horizontal() is not None
    chosen = NEIGHBOURS if located else EVERY_PAIR
    return opened(pairs=chosen)


def _has_choice(dataset: Dataset) -> bool:
    """Whether the user may choose pairs, which is not the case with homographies."""
    return dataset.geometry == "epipolar"
