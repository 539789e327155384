"""The flights of the study that are made and not downloaded: simulated ones, and merged folders."""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import aerocues
from aerocues.errors import DatasetError
from aerocues.progress import Progress


def make_flight(
    settings: Mapping[str, Any], folder: Path, data: Path, progress: Progress | None = None
) -> None:
    """Make a flight, or continue an interrupted one.

    Parameters
    ----------
    settings : mapping
        ``merge``: folders of images, of which later ones replace images of earlier ones of the same
        name; or the arguments of `aerocues.simulate`.
    folder : path
        Of the flight.
    data : path
        Folder of the real images.
    progress : callable, optional

    Raises
    ------
    AerocuesError
        If images are missing, or a setting makes no sense.
    """
    if "merge" not in settings:
        terms = dict(settings)
        aerocues.simulate(terms.pop("survey"), folder, **terms, progress=progress)
        return
    sources = [data / name for name in settings["merge"]]
    if missing := [source for source in sources if not source.is_dir()]:
        raise DatasetError(f"{missing[0]} is missing; set AEROCUES_SHARED_DATA to the images")
    folder.mkdir(parents=True, exist_ok=True)
    content = (file for source in sources for file in sorted(source.iterdir()))
    images = {file.name: file for file in content if file.is_file()}
    for name, file in images.items():
        if not (folder / name).exists():
            # Under another name until it is whole: an interrupted copy is made again.
            shutil.copyfile(file, unfinished := folder / f"{name}.part")
            unfinished.replace(folder / name)
