"""A limit of memory on this process (``ulimit -v``): what comes of it is told in one line.

Under such a limit libraries end the process, or print tracebacks of their own while they are
imported. The command therefore runs in a process of its own, and this one reads what it prints.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Sequence
from types import FrameType
from typing import IO

WATCHED = "AEROCUES_WATCHED"
"""Set in the environment of the process that does the work."""
LEAST = 3 * 10**9
"""Bytes; with less, libraries fail to load now and then, or wait for threads that never start."""
TOO_SMALL = 2
INTERRUPTED = 128
PATIENCE_SECONDS = 30
"""How long the work may go on after a signal to end it."""
SIGNALS = ("SIGINT", "SIGTERM", "SIGHUP")
BEGINNINGS = (
    b"Traceback (most recent call last)",
    b"memory allocation of",
    b"terminate called",
    b"OpenBLAS",
    b"Fatal Python error",
    b"Exception ignored",
    b"thread '",
)
"""How the last words of libraries begin that lack memory."""
HALF_LOADED = b"Polars binary is missing"
LAST_WORDS = 120


def limit_of_memory() -> int | None:
    """The bytes that this process may take, as far as it is limited by itself."""
    try:
        import resource
    except ImportError:
        return None  # no such limits on this system
    limits = (resource.getrlimit(kind)[0] for kind in (resource.RLIMIT_AS, resource.RLIMIT_DATA))
    return min((limit for limit in limits if limit != resource.RLIM_INFINITY), default=None)


class Watched:
    """The command in a process of its own.

    Parameters
    ----------
    arguments : sequence of str
        What stands after ``aerocues``.
    limit : int
        Bytes.
    """

    def __init__(self, arguments: Sequence[str], limit: int) -> None:
        self._limit = limit
        self._ended_by: int | None = None
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-m", "aerocues", *arguments],
            stderr=subprocess.PIPE,
            process_group=0,  # a signal of the terminal comes once: from here
            env={**os.environ, WATCHED: "1"},
        )

    def exit_code(self) -> int:
        """Wait for the end; the exit code, with one line in place of a library's last words."""
        for name in SIGNALS:
            signal.signal(getattr(signal, name), self._pass_on)
        signal.signal(signal.SIGALRM, lambda number, frame: self._process.kill())
        assert self._process.stderr is not None
        held = _copied(self._process.stderr)
        code = self._process.wait()
        failed = code < 0 or (code == 1 and held)
        if not failed:
            sys.stderr.buffer.write(b"".join(held))
            return code
        if self._ended_by is not None:
            sys.stderr.write("interrupted\n")
            return INTERRUPTED + self._ended_by
        sys.stderr.write(f"error: {self._reason(held, code)}\n")
        return TOO_SMALL

    def _pass_on(self, number: int, frame: FrameType | None) -> None:
        self._ended_by = number
        self._process.send_signal(number)
        signal.alarm(PATIENCE_SECONDS)

    def _reason(self, held: list[bytes], code: int) -> str:
        lines = [text for line in held if (text := line.decode(errors="replace").strip())]
        words = lines[-1] if code == 1 else lines[0] if lines else f"signal {-code}"
        return too_small(self._limit, f": {words[:LAST_WORDS]}")


def too_small(limit: int, why: str = "") -> str:
    """What to do about a limit that does not suffice."""
    return (
        f"the memory that this shell allows a process ({limit / 1e9:.1f} GB, see 'ulimit -v') is "
        f"too small{why}; allow 4 GB or more, or 'ulimit -v unlimited'"
    )


def _copied(stream: IO[bytes]) -> list[bytes]:
    """Copy lines to standard error up to the last words of a library, which are kept back."""
    held: list[bytes] = []
    for line in stream:
        if held or line.startswith(BEGINNINGS) or HALF_LOADED in line:
            held.append(line)
        else:
            sys.stderr.buffer.write(line)
            sys.stderr.buffer.flush()
    return held
