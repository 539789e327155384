"""Where a study is: a folder, a packed file, or an address from which that is downloaded once."""

from __future__ import annotations

import hashlib
import os
import re
import tempfile
import zipfile
from contextlib import suppress
from difflib import get_close_matches
from pathlib import Path

from aerocues.errors import AerocuesError, StoreError
from aerocues.results.expanded_size import why_not_decoded
from aerocues.results.store import RUN
from aerocues.scratch_folders import cache_folder

VARIABLE = "AEROCUES_STUDY"
IN_CHECKOUT = Path("study") / "database"
MARK = "study:"
"""Begins the name of a part of a study where results are asked for."""
WEB = ("http://", "https://")
NAME = re.compile(r"[a-z0-9][a-z0-9_-]*")
"""Names of parts, which are folders: small letters, digits, - and _."""
DIGITS = 16


def study_folder(place: str | Path | None = None) -> Path:
    """The folder of a study, downloaded and unpacked where it is not there yet.

    Parameters
    ----------
    place : str or path, optional
        A folder of results folders, a zip file of one, or the web address of such a file; by
        default `AEROCUES_STUDY`, or ``study/database`` of the checkout around this folder.

    Raises
    ------
    StoreError
        If there is none.
    DatasetError
        If it cannot be downloaded or unpacked.
    """
    asked = place or os.environ.get(VARIABLE) or _of_checkout(Path.cwd())
    if asked is None:
        raise StoreError(
            "there is no study here; give its folder, its file or its web address as `place`, set "
            f"{VARIABLE}, or change to the checkout with {IN_CHECKOUT}"
        )
    if str(asked).startswith(WEB):
        folder = _of_download(_downloaded(str(asked)))
    else:
        path = Path(asked).expanduser()
        folder = _unpacked(path) if path.is_file() else path
    if not part_names(folder):
        raise StoreError(f"{asked} is not a study: no folder in it holds results; give another one")
    return folder


def part_names(folder: Path) -> tuple[str, ...]:
    """The names of the parts in a folder: the results folders in it."""
    return tuple(sorted(run.parent.name for run in folder.glob(f"*/{RUN}")))


def part_folder(study: Path, name: str) -> Path:
    """The results folder of a part; StoreError if there is none of that name."""
    names = part_names(study)
    if name not in names:
        close = get_close_matches(name, names, n=3)
        hint = f"did you mean {' or '.join(close)}?" if close else f"there are {', '.join(names)}"
        raise StoreError(f"the study has no part {name!r}; {hint}")
    return study / name


def place_of_results(place: str | Path) -> Path:
    """The path of results; ``study:NAME`` is that part of the study at its usual place."""
    text = str(place)
    if not text.startswith(MARK):
        return Path(place)
    return part_folder(study_folder(), text.removeprefix(MARK))


def refuse_part(place: str | Path) -> None:
    """StoreError if a place to write to is a part of the study, such as ``study:NAME``."""
    if str(place).startswith(MARK):
        raise StoreError(
            f"{place} is a part of the study, which is only read; give a folder of your own"
        )


def _of_checkout(folder: Path) -> Path | None:
    """The database of the checkout that holds a folder."""
    found = (each / IN_CHECKOUT for each in (folder, *folder.parents))
    return next((each for each in found if part_names(each)), None)


def _downloaded(address: str) -> Path:
    """The file of an address; what was downloaded before is taken."""
    from aerocues.datasets.downloading import Downloader

    folder = cache_folder("studies")
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / f"{hashlib.sha256(address.encode()).hexdigest()[:DIGITS]}.zip"
    if not file.exists():
        Downloader(file.with_suffix(".zip.part"))(address, file, None)
    return file


def _of_download(file: Path) -> Path:
    """The folder of a downloaded file, which is removed where it is refused: it may be damaged."""
    try:
        return _unpacked(file)
    except AerocuesError:
        file.unlink(missing_ok=True)
        raise


def _unpacked(file: Path) -> Path:
    """The folder of a packed study, in the cache under the hash of its content."""
    digest = hashlib.sha256(file.read_bytes()).hexdigest()[:DIGITS]
    cache = cache_folder("studies")
    folder = cache / f"{digest}-whole"
    if folder.is_dir():
        return folder
    if not zipfile.is_zipfile(file):
        raise StoreError(f"{file} is not a packed study (a zip file); give another place")
    cache.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=cache, prefix=".unpacking-") as name:
        fresh = Path(name) / "study"
        fresh.mkdir()
        _unpack(file, fresh)
        # Renamed when all of it is checked: what is in the cache is whole.
        with suppress(FileExistsError):
            _rename(fresh, folder)
    return folder


def _unpack(file: Path, folder: Path) -> None:
    from aerocues.datasets.unpacking import unpack_sequences

    unpack_sequences(file, folder, RUN, "study")
    for table in sorted(folder.rglob("*.parquet")):
        if problem := why_not_decoded(table.read_bytes()):
            raise StoreError(f"{file} is not read: in {table.name} {problem}; ask for it once more")


def _rename(fresh: Path, folder: Path) -> None:
    """Rename a folder; FileExistsError if another process was faster."""
    try:
        fresh.rename(folder)
    except OSError as error:
        if folder.is_dir():
            raise FileExistsError from error
        raise
