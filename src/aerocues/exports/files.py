"""A folder with the files of another tool."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

from aerocues.datasets.dataset import Dataset
from aerocues.errors import ReconstructionError, StoreError
from aerocues.exports.flight import Flight, linked_flight
from aerocues.exports.targets import Target
from aerocues.progress import Progress
from aerocues.reconstruction.options import ReconstructionOptions
from aerocues.results.whole_files import json_content, write_whole

WORK, RECORD = ".aerocues", "aerocues.json"


def write_files(
    row: Target,
    dataset: Dataset,
    combination: str,
    folder: Path,
    options: ReconstructionOptions,
    progress: Progress | None,
) -> tuple[str, dict[str, int], tuple[str, ...]]:
    """Write the files of a target.

    Returns
    -------
    tuple of str, dict of str to int, tuple of str
        The combination, what was written, and commands that go on from it.

    Raises
    ------
    AerocuesError
        If the folder holds something else, or the flight cannot be linked.
    """
    write = row.load()
    _check_names(row, dataset)
    _check(folder, row, combination.upper())
    work = folder / WORK
    try:
        work.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise StoreError(
            f"cannot write to {folder}: {error.strerror}; choose another `output`"
        ) from error
    flight = linked_flight(dataset, combination, work, options, progress)
    commands = tuple(write(flight, folder))
    figures = _figures(flight)
    facts = {"target": row.name, "combination": str(flight.combination), **figures}
    write_whole({folder / RECORD: json_content({**facts, "next": commands})})
    shutil.rmtree(work)
    return str(flight.combination), figures, commands


def _figures(flight: Flight) -> dict[str, int]:
    linked = flight.linked
    return {
        "images": len(flight.images),
        "keypoints": sum(len(each) for each in linked.keypoints.values()),
        "linked_pairs": len(linked.pairs),
        "matches": sum(len(each) for each in linked.pairs.values()),
        "verified_pairs": len(flight.verified),
        "verified_matches": sum(len(each) for each in flight.verified.values()),
    }


def _check_names(row: Target, dataset: Dataset) -> None:
    names = [image.name for image in dataset.images]
    unfit = [name for name in names if row.separator and row.separator in name]
    if unfit:
        raise ReconstructionError(
            f"names of images cannot contain {row.separator!r} in the files of {row.name}; rename "
            f"{unfit[0]!r}"
        )


def _check(folder: Path, row: Target, combination: str) -> None:
    """Refuse a folder with something else, which these files would be mixed with."""
    if folder.exists() and not folder.is_dir():
        raise StoreError(f"{folder} is a file; give the name of a folder as `output`")
    others = [] if not folder.is_dir() else [path.name for path in folder.iterdir()]
    if RECORD in others:
        found = json.loads((folder / RECORD).read_text(encoding="utf-8"))
        there = f"{found.get('combination')} for {found.get('target')}"
        if there == f"{combination} for {row.name}":
            return
        raise StoreError(f"{folder} holds {there}; give a new or empty folder as `output`")
    if set(others) - {WORK}:
        raise StoreError(
            f"{folder} holds other files ({others[0]}, ...); give a new or empty folder as `output`"
        )
