"""Unpacks archives of sequences, completely or not at all, and only inside the target."""

from __future__ import annotations

import gzip
import lzma
import shutil
import tarfile
import tempfile
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path, PurePosixPath
from typing import IO

from aerocues.errors import DatasetError
from aerocues.expansion import why_too_large

_BROKEN = (
    tarfile.TarError,
    zipfile.BadZipFile,
    NotImplementedError,
    EOFError,
    zlib.error,
    gzip.BadGzipFile,
    lzma.LZMAError,
)
Members = Iterator[tuple[str, int, IO[bytes]]]
"""Names, sizes and contents; no content is longer than its size."""


def unpack_sequences(archive: Path, to: Path, marker: str, single: str) -> list[str]:
    """Unpack every sequence of an archive into its own folder below `to`.

    Parameters
    ----------
    archive : Path
        A tar (compressed or not) or zip file.
    to : Path
        Folder; an existing sequence is replaced.
    marker : str
        Name of a file in the folder of each sequence, at any depth in the archive.
    single : str
        Name of the sequence if its files are at the top of the archive.

    Returns
    -------
    list of str
        Names of the sequences, sorted.

    Raises
    ------
    DatasetError
        If the archive is damaged, has no sequence, or a member would be written outside `to`.
    """
    with tempfile.TemporaryDirectory(dir=to, prefix=".unpacking-") as name:
        place = Path(name)
        _extract(archive, place)
        found = {
            single if file.parent == place else file.parent.name: file.parent
            for file in sorted(place.rglob(marker))
        }
        if not found:
            raise DatasetError(f"{archive} has no sequence (no file {marker}); remove it and retry")
        for sequence, folder in found.items():
            _put(folder, to / sequence)
        place.mkdir(exist_ok=True)  # it was moved if it was the sequence itself
    return sorted(found)


def _put(folder: Path, target: Path) -> None:
    if target.exists():
        shutil.rmtree(target)
    folder.chmod(0o755)
    folder.rename(target)


def _extract(archive: Path, place: Path) -> None:
    root, size, expanded = place.resolve(), archive.stat().st_size, 0
    try:
        with _members(archive) as members:
            for name, length, content in members:
                expanded += length
                if reason := why_too_large(size, expanded):
                    raise DatasetError(f"{archive} is not unpacked: {reason} or more; remove it")
                target = (root / PurePosixPath(name)).resolve()
                if not target.is_relative_to(root):
                    raise DatasetError(
                        f"{archive} would write outside the folder ({name}); do not use it"
                    )
                target.parent.mkdir(parents=True, exist_ok=True)
                with content, target.open("wb") as file:
                    shutil.copyfileobj(content, file)
    except _BROKEN as error:
        raise DatasetError(
            f"{archive} is damaged ({error}); remove it and download it again"
        ) from error


@contextmanager
def _members(archive: Path) -> Iterator[Members]:
    """The regular files of an archive; links and devices are skipped."""
    if zipfile.is_zipfile(archive):
        with zipfile.ZipFile(archive) as zipped:
            yield (
                (m.filename, m.file_size, zipped.open(m))
                for m in zipped.infolist()
                if not m.is_dir()
            )
    else:
        with tarfile.open(archive) as tar:
            yield (
                (m.name, m.size, file) for m in tar if m.isfile() and (file := tar.extractfile(m))
            )
