"""Locks on files, as each system has them; they end with the process."""

from __future__ import annotations

import sys
from typing import IO


def try_lock(file: IO[str]) -> bool:
    """Lock an open file against other processes; whether that succeeded.

    A system without such locks always succeeds.
    """
    if sys.platform == "win32":
        return _locked_on_windows(file)
    try:
        import fcntl
    except ImportError:
        return True
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


def _locked_on_windows(file: IO[str]) -> bool:
    try:
        import msvcrt
    except ImportError:
        return True
    try:
        # By name, because other systems do not know them.
        getattr(msvcrt, "locking")(file.fileno(), getattr(msvcrt, "LK_NBLCK"), 1)  # noqa: B009
    except OSError:
        return False
    return True
