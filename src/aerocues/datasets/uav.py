"""Pairs of UAV projects: a folder with one folder per project, each with two or more images."""

from __future__ import annotations

from pathlib import Path

from aerocues.datasets.dataset import Dataset, Image, Pair
from aerocues.datasets.folder import (
    chosen_pairs,
    file_images,
    image_paths,
    settings_of,
    subfolders,
)
from aerocues.datasets.options import Options
from aerocues.datasets.pairing import PairsFile
from aerocues.errors import DatasetError


def open_uav(folder: Path, options: Options) -> Dataset:
    """Consecutive images of each project (one pair for a project with two images).

    Folders without images are skipped. Each project is a sequence. A pairs file may list images of
    all projects; a pair belongs to the project of its first image.

    Raises
    ------
    DatasetError
        If there is no project, a project has a single image, or the pairs cannot be formed.
    """
    strategy, text = chosen_pairs(options)
    projects = _projects(folder, options)
    images = [image for own in projects.values() for image in own]
    if isinstance(strategy, PairsFile):
        names = strategy.pairs(images)
    else:
        names = [pair for own in projects.values() for pair in strategy.pairs(own)]
    pairs = [
        Pair(index, first, second, first.partition("/")[0])
        for index, (first, second) in enumerate(names)
    ]
    return Dataset("uav", images, pairs, "epipolar", settings_of(images, options, pairs=text))


def _projects(folder: Path, options: Options) -> dict[str, list[Image]]:
    """The images of each project, by the name of the project."""
    projects: dict[str, list[Image]] = {}
    for project in subfolders(folder):
        paths = image_paths(project)
        if len(paths) == 1:
            raise DatasetError(
                f"the project {project} has only one image; add a second or move the project away"
            )
        if paths:
            projects[project.name], _ = file_images(paths, folder, options)
    if not projects:
        hint = f"; it has images itself: give it as {folder}" if image_paths(folder) else ""
        raise DatasetError(
            f"{folder} has no project folders with two or more images{hint or '; check the path'}"
        )
    return projects
