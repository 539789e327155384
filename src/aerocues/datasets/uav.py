"""Pairs of UAV projects: a folder with one folder a project, each with two or more images."""

from __future__ import annotations

from pathlib import Path

from aerocues.datasets.dataset import Dataset, Image, Pair
from aerocues.datasets.folder import chosen_pairs, file_images, image_paths, subfolders
from aerocues.datasets.options import Options
from aerocues.datasets.pairing import PairsFile
from aerocues.errors import DatasetError


def open_uav(folder: Path, options: Options) -> Dataset:
    """Every project's consecutive images (with two images: one pair a project).

    Folders without images are passed over. A project is a sequence. A pairs file may name images
    of all projects; a pair belongs to the project of its first image.

    Raises
    ------
    DatasetError
        If there is no project, or one with a single image, or the pairs cannot be made.
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
    return Dataset("uav", images, pairs, "epipolar", options.settings(pairs=text))


def _projects(folder: Path, options: Options) -> dict[str, list[Image]]:
    """The images of each project by its name, which begins theirs."""
    projects: dict[str, list[Image]] = {}
    for project in subfolders(folder):
        paths = image_paths(project)
        if len(paths) == 1:
            raise DatasetError(
                f"the project {project} holds one image only; add a second or move it away"
            )
        if paths:
            projects[project.name] = file_images(paths, folder, options)
    if not projects:
        hint = f"; it holds images itself: give it as {folder}" if image_paths(folder) else ""
        raise DatasetError(
            f"{folder} has no project folders with two or more images{hint or '; check the path'}"
        )
    return projects
