"""The memory that processes here may take together: that of the machine, or of their container."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

GROUPS = Path("/proc/self/cgroup")
MOUNTED = Path("/sys/fs/cgroup")
UNLIMITED = 1 << 60
"""Older kernels write a number beyond this in place of no limit."""


def memory_bytes() -> int:
    """Bytes of memory: the machine's, or less where a container or a batch system limits it."""
    import psutil

    return min((psutil.virtual_memory().total, *_limits(GROUPS, MOUNTED)))


def _limits(groups: Path, mounted: Path) -> Iterator[int]:
    """The limits of the control groups that this process is in, and of those above them."""
    try:
        lines = groups.read_text(encoding="utf-8").splitlines()
    except OSError:
        return  # this system has none
    for line in lines:
        number, controllers, path = line.split(":", 2)
        if number == "0":
            place, name = mounted, "memory.max"
        elif "memory" in controllers.split(","):
            place, name = mounted / "memory", "memory.limit_in_bytes"
        else:
            continue
        inner = Path(path.lstrip("/"))
        # Within a container its own group is at the top, whatever it is called outside.
        for group in (inner, *inner.parents):
            try:
                text = (place / group / name).read_text(encoding="ascii").strip()
            except OSError:
                continue
            if text.isdecimal() and int(text) < UNLIMITED:
                yield int(text)
