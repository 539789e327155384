"""A lock that lets only one process write to a folder."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path

from aerocues.errors import StoreError
from aerocues.file_locks import try_lock

LOCK = ".lock"


@contextlib.contextmanager
def folder_lock(folder: Path) -> Iterator[None]:
    """Lock a folder against other runs, until the block or the process ends.

    Raises
    ------
    StoreError
        If another process is writing to the folder, or the folder is not writable.
    """
    try:
        file = (folder / LOCK).open("w")
    except OSError as error:
        raise StoreError(
            f"cannot write to {folder}: {error.strerror}; make room or access, or choose another "
            "`output`"
        ) from error
    with file:
        if not try_lock(file):
            raise StoreError(
                f"another run is writing to {folder}; wait for it or choose another `output`"
            )
        yield
