"""Images in folders, named and in natural order, and datasets of them."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path

from aerocues.datasets.dataset import Dataset, Image, Pair
from aerocues.datasets.file_sources import file_sources, told_levels
from aerocues.datasets.header import SUFFIXES
from aerocues.datasets.listing import (
    Listing,
    has_thumbnails,
    is_own_output,
    list_images,
    natural_key,
)
from aerocues.datasets.metadata import read_metadata
from aerocues.datasets.oddities import oddities
from aerocues.datasets.options import Options
from aerocues.datasets.pairing import Consecutive, GpsNeighbours, Names, PairStrategy, parse_pairs
from aerocues.datasets.usable_gps import UsableGps, told_left_out
from aerocues.errors import DatasetError
from aerocues.phrases import count, printable


def image_paths(folder: Path) -> list[Path]:
    """Image files of a folder, by suffix, in natural order; see `list_images`."""
    return list(list_images(folder).images)


def subfolders(folder: Path) -> list[Path]:
    """Visible folders in a folder, in natural order, without thumbnails and results of aerocues."""
    try:
        found = [p for p in folder.iterdir() if p.is_dir() and not p.name.startswith(".")]
    except OSError as error:
        raise DatasetError(
            f"cannot read the folder {folder}: {error.strerror}; check its path"
        ) from error
    kept = [path for path in found if not has_thumbnails(path) and not is_own_output(path)]
    return sorted(kept, key=lambda path: natural_key(path.name))


def file_images(
    paths: Iterable[Path], root: Path, options: Options
) -> tuple[list[Image], list[str]]:
    """Images of files, named by their path relative to `root`, and what looks odd among them.

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
    files = {named[source.path]: source.path for source in sources}
    metadata = {name: read_metadata(path) for name, path in files.items()}
    images = [
        Image(name, source, metadata[name].gps, yaw=metadata[name].yaw)
        for name, source in zip(files, sources, strict=True)
    ]
    return images, oddities(files, metadata)


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
    return _one_scene(folder, *folder_images(folder, options), options)


def open_flight(folder: Path, options: Options) -> Dataset:
    """The images of a flight: of a folder and all folders below it, sorted by name."""
    return _one_scene(folder, *folder_images(folder, options, tree=True), options)


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
    images, odd = file_images(files, folder, options)
    return _one_scene(folder, images, told_images(len(images), [], odd), options)


def folder_images(
    folder: Path, options: Options, *, tree: bool = False
) -> tuple[list[Image], tuple[str, ...]]:
    """The images (at least two) of a folder or of all folders below it, and a line about them.

    Raises
    ------
    DatasetError
        If there are fewer than two.
    """
    listing = list_images(folder, tree=tree)
    images, odd = file_images(listing.images, folder, options)
    if len(images) < 2:
        raise DatasetError(_too_few(folder, [image.name for image in images], listing, tree=tree))
    return images, told_images(len(images), listing.told(), odd)


def told_images(taken: int, left_out: Sequence[str], odd: Sequence[str]) -> tuple[str, ...]:
    """What was taken, what was left out and what looks odd, in one line; none if there is nothing.

    ``6 images; left out: output of aerocues (models); odd: 1 identical copy (b.jpg is a.jpg)``.
    """
    if not left_out and not odd:
        return ()
    told = [count(taken, "image")]
    told += [f"left out: {', '.join(left_out)}"] if left_out else []
    told += [f"odd: {', '.join(odd)}"] if odd else []
    return ("; ".join(told),)


def _one_scene(
    folder: Path, images: Sequence[Image], notes: tuple[str, ...], options: Options
) -> Dataset:
    strategy, text = chosen_pairs(options)
    settings = settings_of(images, options, pairs=text)
    scene = scene_of(folder, images, strategy.pairs(images), settings)
    if isinstance(strategy, GpsNeighbours):
        faults = UsableGps.of([image.gps for image in images]).in_plan
        left_out = {image.name: why for image, why in zip(images, faults, strict=True) if why}
        notes = (*notes, told_left_out(left_out)) if left_out else notes
    return replace(scene, notes=notes)


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


def _too_few(folder: Path, names: Sequence[str], listing: Listing, *, tree: bool) -> str:
    left_out = "".join(f"; left out: {each}" for each in listing.told())
    if names:
        return f"{folder} has only one image ({names[0]}); a pair needs two: add some{left_out}"
    message = f"{folder} has no images ({', '.join(sorted(SUFFIXES))}){left_out}; "
    inside = [] if tree else [each.name for each in subfolders(folder) if image_paths(each)]
    if inside:
        return f"{message}give one of its folders ({inside[0]}), uav:{folder} or flight:{folder}"
    return message + "check the path"
