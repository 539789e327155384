"""What worker processes on this machine may use: how many there are, and the memory of each."""

from __future__ import annotations

import os

from aerocues.arguments import check_number, check_whole
from aerocues.defaults import LEAST_MEMORY
from aerocues.processes.memory import memory_bytes

MEGABYTES = 1024
SHARE_OF_MEMORY = 0.8


def usable_cores() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def worker_count(workers: int | None) -> int:
    """Processes at a time: as many as asked for, or as there are cores and memory for.

    Raises
    ------
    ArgumentError
        If it is not a whole number, 1 or more.
    """
    if workers is None:
        enough = int(SHARE_OF_MEMORY * memory_bytes() / 2**30 / LEAST_MEMORY)
        return max(min(usable_cores(), enough), 1)
    check_whole("workers", workers, 1)
    return workers


def memory_mb(memory_limit: float | None) -> int | None:
    """Megabytes of a limit in gigabytes; None stays.

    Raises
    ------
    ArgumentError
        If it is less than any worker needs.
    """
    if memory_limit is None:
        return None
    check_number("memory_limit", memory_limit, LEAST_MEMORY)
    return int(memory_limit * MEGABYTES)


def share_of_memory(workers: int) -> int:
    """Megabytes of each of some processes: their part of 80 % of the memory."""
    return int(SHARE_OF_MEMORY * memory_bytes() / 2**20 / workers)
