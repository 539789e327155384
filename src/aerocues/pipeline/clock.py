"""Timing of single stage calls, and the memory that they take."""

from __future__ import annotations

import ctypes
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import TypeVar

import cv2

from aerocues.results.timing import DISTURBED

Result = TypeVar("Result")
PROCESS = Path("/proc/self")
# A stage is called again until it was called so often, or has taken so long in all.
REPEATS, SECONDS_OF_REPEATS = 3, 1.0
# Shorter calls tell nothing of that: asking for the time takes too large a part of them.
SHORTEST = 0.001


@dataclass(frozen=True)
class StageTime:
    """Seconds of one stage: the median of its calls.

    Parameters
    ----------
    wall, cpu : float
        Seconds.
    peak_memory : float or None
        Rise of the resident set in MB, where it was measured.
    repeats : int or None
        Calls behind the median; None where one call was all that was asked for.
    spread : float or None
        Slowest less fastest call, over the median, in CPU seconds; None with fewer than two calls,
        and where they are too short to tell.
    """

    wall: float
    cpu: float
    peak_memory: float | None = None
    repeats: int | None = None
    spread: float | None = None

    def __add__(self, later: StageTime) -> StageTime:
        """The time of two calls after each other, as if they were one."""
        return StageTime(
            self.wall + later.wall,
            self.cpu + later.cpu,
            _known(max, self.peak_memory, later.peak_memory),
            _known(min, self.repeats, later.repeats),
            _known(max, self.spread, later.spread),
        )

    @property
    def wall_over_cpu(self) -> float | None:
        """How much longer the wall time is; None where the call is too short to tell."""
        return self.wall / self.cpu if self.cpu >= SHORTEST else None

    @property
    def disturbed(self) -> bool:
        ratio = self.wall_over_cpu
        return ratio is not None and ratio > DISTURBED


NO_TIME = StageTime(0.0, 0.0)
"""Of a stage that a combination does without."""


class Clock:
    """Times calls, with all threads that they start, OpenCV's random numbers seeded before each.

    An exclusive clock calls again, for the median of several calls; calls that were disturbed are
    made up for. It measures the rise of the resident set during each first call, too, where the
    operating system allows it (Linux).

    Parameters
    ----------
    seed : int
    exclusive : bool
    """

    def __init__(self, seed: int = 0, *, exclusive: bool = False) -> None:
        self._seed = seed
        self._exclusive = exclusive
        self._memory = exclusive and (PROCESS / "clear_refs").exists()

    def time(self, call: Callable[[], Result]) -> tuple[Result, StageTime]:
        """What the first call returns, and how long such a call takes."""
        if self._memory:
            _return_freed_memory()
        before = self._resident(reset=True)
        result, first = self._once(call)
        after = self._resident(reset=False)
        rise = None if before is None or after is None else max(after - before, 0.0)
        if not self._exclusive:
            return result, first
        times = [first]
        while len(times) < REPEATS and sum(each.wall for each in times) < SECONDS_OF_REPEATS:
            times.append(self._once(call)[1])
        return result, _summary(self._made_up_for(times, call), rise)

    def _made_up_for(self, times: list[StageTime], call: Callable[[], Result]) -> list[StageTime]:
        """The calls that nothing disturbed, and others in place of those that were.

        Where all are disturbed, they stand as they are. Long calls get one more attempt only.
        """
        attempts = len(times) if times[0].wall < SECONDS_OF_REPEATS else 1
        calm = [each for each in times if not each.disturbed]
        wanted = len(times)
        while len(calm) < wanted and attempts:
            attempts -= 1
            times.append(self._once(call)[1])
            calm = [each for each in times if not each.disturbed]
        return calm or times

    def _once(self, call: Callable[[], Result]) -> tuple[Result, StageTime]:
        cv2.setRNGSeed(self._seed)
        wall, cpu = time.perf_counter(), time.process_time()  # of all threads that a method starts
        result = call()
        cpu, wall = time.process_time() - cpu, time.perf_counter() - wall
        return result, StageTime(wall, cpu)

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


def _summary(times: list[StageTime], rise: float | None) -> StageTime:
    wall, cpu = (median(getattr(each, name) for each in times) for name in ("wall", "cpu"))
    spread = None
    if len(times) > 1 and cpu >= SHORTEST:
        seconds = [each.cpu for each in times]
        spread = (max(seconds) - min(seconds)) / cpu
    return StageTime(wall, cpu, rise, len(times), spread)


Number = TypeVar("Number", int, float)


def _known(
    choose: Callable[[Number, Number], Number], first: Number | None, second: Number | None
) -> Number | None:
    """What `choose` makes of two numbers; the known one where the other is not."""
    if first is None or second is None:
        return second if first is None else first
    return choose(first, second)


def _return_freed_memory() -> None:
    """Give back what earlier calls freed, else a call that reuses it seems to need nothing."""
    trim = getattr(ctypes.CDLL(None), "malloc_trim", None)
    if trim is not None:
        trim(0)
