"""Folders for what may be deleted: temporary ones, and the cache.

Names of temporary folders tell which process made them, to remove what killed ones left.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import platform
import re
import shutil
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

KINDS = ("worker", "packed", "plug-in")
SECONDS_OF_DOUBT = 5.0
"""A process that began so much later than its folder changed is another one of its number."""


def scratch_prefix(kind: str) -> str:
    """How the name of a temporary folder of this process begins; `kind` is one of `KINDS`."""
    return f"aerocues-{kind}-{_host()}-{os.getpid()}-"


def remove_left_over() -> None:
    """Remove the folders of processes that were killed, of this user on this machine."""
    for folder in _left_over():
        shutil.rmtree(folder, ignore_errors=True)


def _left_over() -> Iterator[Path]:
    import psutil

    pattern = re.compile(rf"aerocues-({'|'.join(KINDS)})-{_host()}-(\d+)-\w+")
    for folder in Path(tempfile.gettempdir()).glob("aerocues-*"):
        name = pattern.fullmatch(folder.name)
        if name is None:
            continue
        # Others may remove it meanwhile, or it is another user's.
        with contextlib.suppress(OSError, psutil.AccessDenied):
            state = folder.lstat()
            if hasattr(os, "getuid") and state.st_uid != os.getuid():
                continue
            try:
                began = psutil.Process(int(name[2])).create_time()
            except psutil.NoSuchProcess:
                yield folder
            else:
                if began > state.st_mtime + SECONDS_OF_DOUBT:
                    yield folder


def _host() -> str:
    """The machine: containers that share a folder have process numbers of their own."""
    return hashlib.sha256(platform.node().encode()).hexdigest()[:6]


def cache_folder(kind: str) -> Path:
    """Where what can be had again is kept; `AEROCUES_CACHE` names another place."""
    if own := os.environ.get("AEROCUES_CACHE"):
        return Path(own) / kind
    if sys.platform == "win32":
        base = Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
    elif sys.platform == "darwin":
        base = Path.home() / "Library" / "Caches"
    else:
        base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return base / "aerocues" / kind
