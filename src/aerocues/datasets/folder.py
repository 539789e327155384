"""Images in folders: found, named, in natural order; datasets made of them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from pathlib import Path

from aerocues.datasets.dataset import Dataset, Image, Pair
from aerocues.datasets.decoding import FileSource
from aerocues.datasets.gps import read_gps
from aerocues.datasets.header import SUFFIXES
from aerocues.datasets.options import Options
from aerocues.datasets.pairing import Consecutive, PairStrategy, parse_pairs
from aerocues.errors import DatasetError


def natural_key(name: str) -> tuple[tuple[int, int, str], ...]:
    """Sort key under which ``img2`` stands before ``img10``, whatever the case of letters."""
    parts = re.split(r"([0-9]+)", name.casefold())
    keyed = ((i % 2, int(part) if i % 2 else 0, part) for i, part in enumerate(parts))
    return (*keyed, (0, 0, name))


def image_paths(folder: Path, *, tree: bool = False) -> list[Path]:
    """Image files of a folder (or of all folders below it), by suffix, in natural order.

    Hidden files are no images: some systems put a ``._NAME.jpg`` beside every ``NAME.jpg``.
    """
    try:
        found = list(folder.rglob("*") if tree else folder.iterdir())
    except OSError as error:
        raise DatasetError(
            f"cannot read the folder {folder}: {error.strerror}; check its path"
        ) from error
    images = [
        path
        for path in found
        if path.suffix.lower() in SUFFIXES
        and not any(part.startswith(".") for part in path.relative_to(folder).parts)
        and path.is_file()
    ]
    return sorted(images, key=lambda path: natural_key(path.relative_to(folder).as_posix()))


def subfolders(folder: Path) -> list[Path]:
    """Visible folders in a folder, in natural order."""
    try:
        found = [p for p in folder.iterdir() if p.is_dir() and not p.name.startswith(".")]
    except OSError as error:
        raise DatasetError(
            f"cannot read the folder {folder}: {error.strerror}; check its path"
        ) from error
    return sorted(found, key=lambda path: natural_key(path.name))


def file_images(paths: Iterable[Path], root: Path, options: Options) -> list[Image]:
    """Images of files, named by their path relative to `root`, with GPS where EXIF has it."""
    return [
        Image(
            path.relative_to(root).as_posix(),
            FileSource(path.absolute(), options.max_width, options.equalize),
            read_gps(path),
        )
        for path in paths
    ]


def chosen_pairs(options: Options) -> tuple[PairStrategy, str]:
    """The pair strategy asked for, consecutive by default, and its text for the records."""
    if options.pairs is None:
        return Consecutive(), "consecutive"
    return parse_pairs(options.pairs), options.pairs


def open_folder(folder: Path, options: Options) -> Dataset:
    """The images of one plain folder.

    Raises
    ------
    DatasetError
        If there are fewer than two images, or the pairs cannot be made.
    """
    return _one_scene(folder, image_paths(folder), options)


def open_flight(folder: Path, options: Options) -> Dataset:
    """The images of a flight: of a folder and of all folders below it, in order of their names."""
    return _one_scene(folder, image_paths(folder, tree=True), options)


def _one_scene(folder: Path, paths: Sequence[Path], options: Options) -> Dataset:
    if len(paths) < 2:
        raise DatasetError(_too_few(folder, paths))
    images = file_images(paths, folder, options)
    strategy, text = chosen_pairs(options)
    name = folder.resolve().name or "folder"
    pairs = [Pair(i, a, b, name) for i, (a, b) in enumerate(strategy.pairs(images))]
    return Dataset(name, images, pairs, "epipolar", options.settings(pairs=text))


def _too_few(folder: Path, paths: Sequence[Path]) -> str:
    if paths:
        return f"{folder} holds one image only ({paths[0].name}); two or more make a pair: add some"
    message = f"{folder} holds no images ({', '.join(sorted(SUFFIXES))}); "
    inside = [child.name for child in subfolders(folder) if image_paths(child)]
    if inside:
        return f"{message}give one of its folders ({inside[0]}), uav:{folder} or flight:{folder}"
    return message + "check the path"
