"""Files that are written atomically."""

from __future__ import annotations

import io
import json
import os
import time
from collections.abc import Mapping
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

from aerocues.results.checksums import with_checksum

if TYPE_CHECKING:
    import polars as pl

ON_WINDOWS = os.name == "nt"
PAUSES = (0.05, 0.1, 0.2, 0.4, 0.5, 0.75)
"""Seconds between tries."""


def write_whole(contents: Mapping[Path, bytes | memoryview]) -> None:
    """Write files under other names and rename them when all of them are on the disk.

    Until then nothing is replaced, even if writing is interrupted, and no temporary files remain.

    Raises
    ------
    OSError
        If the disk is full or a folder is not writable.
    """
    with ExitStack() as clean_up:
        ready: list[tuple[Path, Path]] = []
        for target, content in contents.items():
            beside = target.with_name(f"{target.name}.{os.getpid()}.tmp")
            clean_up.callback(_remove, beside)
            with beside.open("wb") as file:
                file.write(content)
                file.flush()
                os.fsync(file.fileno())
            ready.append((beside, target))
        for beside, target in ready:
            put_in_place(beside, target)


def put_in_place(beside: Path, target: Path) -> None:
    """Give a file its name; an existing file is replaced.

    Windows refuses that while a reader has it open: then it is tried again for two seconds.
    """
    for pause in PAUSES if ON_WINDOWS else ():
        try:
            beside.replace(target)
        except PermissionError:
            time.sleep(pause)
        else:
            return
    beside.replace(target)


def _remove(path: Path) -> None:
    with suppress(OSError):  # an inaccessible folder was already reported
        path.unlink(missing_ok=True)


def parquet_content(table: pl.DataFrame) -> bytes:
    """A table as the content of a file with a checksum.

    It is not written by polars, which has its own errors for a full disk.
    """
    content = io.BytesIO()
    table.write_parquet(content, compression="zstd")
    return with_checksum(content.getvalue())


def json_content(facts: Mapping[str, Any]) -> bytes:
    """Facts about a run as the content of ``run.json``."""
    return (json.dumps(facts, indent=2, sort_keys=True, default=str) + "\n").encode()
