"""Small datasets written to files, and tables made comparable."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

import cv2
import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.dataset import Dataset, Geometry, Image, Pair
from aerocues.datasets.decoding import FileSource
from aerocues.methods.presets import Preset
from aerocues.results.schema import COLUMNS, HOW_TIMED
from tests.methods.pictures import textured

if TYPE_CHECKING:
    import polars as pl

Picture = NDArray[np.uint8]
Rows = dict[tuple[object, ...], dict[str, object]]

NAMES = ("dataset", "pair", "image_1", "image_2", "detector", "descriptor", "norm", "matcher")
# What differs from run to run: times, what follows from them, and where they were taken.
CHANGING = (
    frozenset(c.name for c in COLUMNS if c.unit in ("s", "MB"))
    | {column.name for column in HOW_TIMED}
    | {"timing", "machine"}
)


# For tests of anything but quality: the reference of a pair takes longer than the rest of it.
PLAIN = Preset("plain", "no question about chance", chance_test=False)


def write_dataset(
    folder: Path,
    pictures: Mapping[str, Picture],
    pairs: Sequence[tuple[str, str]] | None = None,
    homographies: Sequence[NDArray[np.float64] | None] | None = None,
    sequences: Sequence[str] | None = None,
    name: str = "scene",
) -> Dataset:
    """PNG files and their dataset; neighbours are paired unless `pairs` says otherwise."""
    folder.mkdir(parents=True, exist_ok=True)
    for title, picture in pictures.items():
        assert cv2.imwrite(str(folder / title), picture)
    return dataset_of(folder, list(pictures), pairs, homographies, sequences, name)


def dataset_of(
    folder: Path,
    titles: Sequence[str],
    pairs: Sequence[tuple[str, str]] | None = None,
    homographies: Sequence[NDArray[np.float64] | None] | None = None,
    sequences: Sequence[str] | None = None,
    name: str = "scene",
) -> Dataset:
    """The dataset of files that are there already."""
    chosen = list(pairwise(titles)) if pairs is None else pairs
    truths = homographies or [None] * len(chosen)
    scenes = sequences or [name] * len(chosen)
    geometry: Geometry = "homography" if homographies else "epipolar"
    return Dataset(
        name,
        [Image(title, FileSource(folder / title)) for title in titles],
        [
            Pair(index, first, second, scene, truth)
            for index, ((first, second), truth, scene) in enumerate(
                zip(chosen, truths, scenes, strict=True)
            )
        ],
        geometry,
    )


def strip(count: int, width: int = 240, height: int = 180, step: int = 9) -> dict[str, Picture]:
    """Views of one picture, each `step` pixels further to the right than the one before."""
    whole = textured(width + step * (count - 1), height, seed=5)
    return {
        f"view_{i}.png": np.ascontiguousarray(whole[:, step * i : step * i + width])
        for i in range(count)
    }


def shift_of_strip(step: int = 9) -> NDArray[np.float64]:
    """The homography between neighbours of a strip."""
    return np.array([[1, 0, -step], [0, 1, 0], [0, 0, 1]], np.float64)


def rows_of(table: pl.DataFrame) -> Rows:
    """Rows by what names them, without what changes from run to run."""
    rows = {
        tuple(row[name] for name in NAMES): {k: v for k, v in row.items() if k not in CHANGING}
        for row in table.to_dicts()
    }
    assert len(rows) == len(table)
    return rows


def assert_same_rows(got: Rows, expected: Rows) -> None:
    """Equal rows, with the first difference named."""
    assert got.keys() == expected.keys()
    for name, row in expected.items():
        different = {k: (got[name][k], v) for k, v in row.items() if not _equal(got[name][k], v)}
        assert not different, (name, different)


def _equal(first: object, second: object) -> bool:
    return first == second or (first != first and second != second)
