"""Images in folders, named and in natural order, and datasets of them."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Sequence
from pathlib import Path

from aerocues.datasets.dataset import Dataset, Image, Pair
from aerocues.datasets.file_sources import file_sources, told_levels
from aerocues.datasets.gps import read_gps
from aerocues.datasets.header import SUFFIXES
from aerocues.datasets.options import Options
from aerocues.datasets.pairing import Consecutive, Names, PairStrategy, parse_pairs
from aerocues.errors import DatasetError
from aerocues.phrases import printable


def natural_key(name: str) -> tuple[tuple[int, int, str], ...]:
    """Sort key that puts ``img2`` before ``img10``, ignoring case."""
    parts = re.split(r"([0-9]+)", name.casefold())
    keyed = ((i % 2, int(part) if i % 2 else 0, part) for i, part in enumerate(parts))
    return (*keyed, (0, 0, name))


def image_paths(folder: Path, *, tree: bool = False) -> list[Path]:
    """Image files of a folder (or of all folders below it), by suffix, in natural order.

    Hidden files are skipped: some systems create a ``._NAME.jpg`` for every ``NAME.jpg``.
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
    """Images of files, named by their path relative to `root`, with GPS from EXIF if present.

    Raises
    ------
    DatasetError
        If the subset of the options has no file, or a band must be chosen.
    """
    names = {printable(path.relative_to(root).as_posix()): path for path in paths}
    chosen = {name: path for name, path in names.items() if options.takes(name)}
    if names and not chosen:
        folders = dict.fromkeys(name.rpartition("/")[0] or name for name in names)
        shown = ", ".join(list(folders)[:4]) + (", ..." if len(folders) > 4 else "")
        raise DatasetError(
            f'no image of {root} is in `subset="{options.subset}"`; there are: {shown}'
        )
    named = {path.absolute(): name for name, path in chosen.items()}
    sources = file_sources(list(chosen.values()), options, root)
    return [Image(named[source.path], source, read_gps(source.path)) for source in sources]


def chosen_pairs(options: Options) -> tuple[PairStrategy, str]:
    """The pair strategy of the options (consecutive by default), and its text form."""
    if options.pairs is None:
        return Consecutive(), "consecutive"
    return parse_pairs(options.pairs), options.pairs


def open_folder(folder: Path, options: Options) -> Dataset:
    """The images of one plain folder.

    Raises
    ------
    DatasetError
        If there are fewer than two images, or the pairs cannot be formed.
    """
    return _one_scene(folder, folder_images(folder, options), options)


def open_flight(folder: Path, options: Options) -> Dataset:
    """The images of a flight: of a folder and all folders below it, sorted by name."""
    return _one_scene(folder, folder_images(folder, options, tree=True), options)


def folder_of(files: Sequence[Path]) -> Path:
    """The folder that holds all of some files, directly or below it.

    Raises
    ------
    DatasetError
        If there are fewer than two files, one of them is not there, or one is given twice.
    """
    if len(files) < 2:
        raise DatasetError("two or more image files make a dataset; give more, or their folder")
    for file in files:
        if not file.is_file():
            raise DatasetError(f"there is no file {file}; check the path")
        if files.count(file) > 1:
            raise DatasetError(f"{file} is given twice; give each image once")
    return Path(os.path.commonpath([file.parent for file in files]))


def open_files(folder: Path, files: Sequence[Path], options: Options) -> Dataset:
    """The images of some files in a folder or below it, in their order."""
    return _one_scene(folder, file_images(files, folder, options), options)


def folder_images(folder: Path, options: Options, *, tree: bool = False) -> list[Image]:
    """The images (at least two) of a folder, or of all folders below it.

    Raises
    ------
    DatasetError
        If there are fewer than two.
    """
    paths = image_paths(folder, tree=tree)
    images = file_images(paths, folder, options)
    if len(images) < 2:
        raise DatasetError(_too_few(folder, [image.name for image in images]))
    return images


def _one_scene(folder: Path, images: Sequence[Image], options: Options) -> Dataset:
    strategy, text = chosen_pairs(options)
    settings = settings_of(images, options, pairs=text)
    return scene_of(folder, images, strategy.pairs(images), settings)


def settings_of(
    images: Sequence[Image], options: Options, **more: str
) -> tuple[tuple[str, str], ...]:
    """How images are read, for `Dataset.settings`: options, and the range of their values."""
    values = told_levels(image.source for image in images)
    return options.settings(**more, **({"values": values} if values else {}))


def scene_of(
    folder: Path,
    images: Sequence[Image],
    pairs: Iterable[Names],
    settings: tuple[tuple[str, str], ...],
) -> Dataset:
    """The dataset of images of one scene."""
    name = printable(folder.resolve().name) or "folder"
    numbered = [Pair(i, first, second, name) for i, (first, second) in enumerate(pairs)]
    return Dataset(name, images, numbered, "epipolar", settings)


def _too_few(folder: Path, names: Sequence[str]) -> str:
    if names:
        return f"{folder} has only one image ({names[0]}); a pair needs two: add some"
    message = f"{folder} has no images ({', '.join(sorted(SUFFIXES))}); "
    inside = [child.name for child in subfolders(folder) if image_paths(child)]
    if inside:
        return f"{message}give one of its folders ({inside[0]}), uav:{folder} or flight:{folder}"
    return message + "check the path"
