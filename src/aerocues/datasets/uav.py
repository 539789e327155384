"""Pairs of UAV projects: a folder with one folder a project, each with two or more images."""

from __future__ import annotations

from pathlib import Path

from aerocues.datasets.dataset import Dataset, Image, Pair
from aerocues.datasets.folder import chosen_pairs, file_images, image_paths, subfolders
from aerocues.datasets.options import Options
from aerocues.errors import DatasetError


def open_uav(folder: Path, options: Options) -> Dataset:
    """Every project's consecutive images (with two images: one pair a project).

    Folders without images are passed over. A project is a sequence.

    Raises
    ------
    DatasetError
        If there is no project, or one with a single image.
    """
    strategy, text = chosen_pairs(options)
    images: list[Image] = []
    pairs: list[Pair] = []
    for project in subfolders(folder):
        paths = image_paths(project)
        if len(paths) == 1:
            raise DatasetError(
                f"the project {project} holds one image only; add a second or move it away"
            )
        if paths:
            own = file_images(paths, folder, options)
            images += own
            pairs += [
                Pair(len(pairs) + i, first, second, project.name)
                for i, (first, second) in enumerate(strategy.pairs(own))
            ]
    if not pairs:
        hint = f"; it holds images itself: give it as {folder}" if image_paths(folder) else ""
        raise DatasetError(
            f"{folder} has no project folders with two or more images{hint or '; check the path'}"
        )
    return Dataset("uav", images, pairs, "epipolar", options.settings(pairs=text))
