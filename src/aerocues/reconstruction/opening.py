"""Opening a scene: pairs by GPS where images have it, else all pairs."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path

from aerocues.datasets.catalog import open_dataset
from aerocues.datasets.dataset import Dataset

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
) -> Dataset:
    """Open a dataset to reconstruct it.

    Consecutive images alone tear a flight over a grid apart: where no pairs are asked for, images
    are matched with their neighbours by GPS, and where those are not known, with all others.

    Parameters
    ----------
    spec, pairs, max_width, equalize, sequences, subset
        As `aerocues.open_dataset` takes them.

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
    )
    scene = opened(pairs=pairs)
    if pairs is not None or not _has_choice(scene):
        return scene
    located = all(image.gps is not None for image in scene.images)
    chosen = NEIGHBOURS if located else EVERY_PAIR
    return opened(pairs=chosen)


def _has_choice(dataset: Dataset) -> bool:
    """Whether pairs of the user's choice make sense: not with homographies."""
    return dataset.geometry == "epipolar"
