"""Timing of single stage calls, and the memory that they take."""

from __future__ import annotations

import ctypes
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

Result = TypeVar("Result")
PROCESS = Path("/proc/self")


@dataclass(frozen=True)
class StageTime:
    """Wall and CPU seconds of one stage call; peak_memory is its rise of memory in MB, if known."""

    wall: float
    cpu: float
    peak_memory: float | None = None

    def __add__(self, later: StageTime) -> StageTime:
        peaks = [peak for peak in (self.peak_memory, later.peak_memory) if peak is not None]
        return StageTime(
            self.wall + later.wall, self.cpu + later.cpu, max(peaks) if peaks else None
        )


class Clock:
    """Times calls in the calling thread.

    With `memory`, the rise of the resident set during each call is measured too, where the
    operating system allows it (Linux); it costs a little and is for exclusive timing only.
    """

    def __init__(self, *, memory: bool) -> None:
        self._memory = memory and (PROCESS / "clear_refs").exists()

    def time(self, call: Callable[[], Result]) -> tuple[Result, StageTime]:
        if self._memory:
            _return_freed_memory()
        before = self._resident(reset=True)
        wall, cpu = time.perf_counter(), time.thread_time()
        result = call()
        cpu, wall = time.thread_time() - cpu, time.perf_counter() - wall
        after = self._resident(reset=False)
        rise = None if before is None or after is None else max(after - before, 0.0)
        return result, StageTime(wall, cpu, rise)

    def _resident(self, *, reset: bool) -> float | None:
        """Resident set in MB: now, with the high-water mark reset; else the high-water mark."""
        if not self._memory:
            return None
        if reset:
            try:
                (PROCESS / "clear_refs").write_text("5")
            except OSError:
                # Containers may forbid it; memory then stays unknown.
                self._memory = False
                return None
        field = "VmRSS:" if reset else "VmHWM:"
        for line in (PROCESS / "status").read_text().splitlines():
            if line.startswith(field):
                return int(line.split()[1]) / 1024
        return None


def _return_freed_memory() -> None:
    """Give back what earlier calls freed, else a call that reuses it seems to need nothing."""
    trim = getattr(ctypes.CDLL(None), "malloc_trim", None)
    if trim is not None:
        trim(0)
