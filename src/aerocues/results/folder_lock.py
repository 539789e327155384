"""One process at a time may write to a folder."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import IO

from aerocues.errors import StoreError

LOCK = ".lock"


@contextlib.contextmanager
def folder_lock(folder: Path) -> Iterator[None]:
    """Keep other runs out of a folder; the lock goes with the block or the process.

    Raises
    ------
    StoreError
        If another process is writing to the folder, or it cannot be written.
    """
    try:
        file = (folder / LOCK).open("w")
    except OSError as error:
        raise StoreError(
            f"cannot write to {folder}: {error.strerror}; make room or access, or choose another "
            "`output`"
        ) from error
    with file:
        if not _locked(file):
            raise StoreError(
                f"another run is writing to {folder}; wait for it or choose another `output`"
            )
        yield


def _locked(file: IO[str]) -> bool:
    """Whether the lock could be had."""
    try:
        import fcntl
    except ImportError:
        return True  # no such locks on this system
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True
