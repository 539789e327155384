"""The parent's side of a worker process."""

from __future__ import annotations

import os

from aerocues.evaluation.unit import Context, Unit
from aerocues.processes.child_process import ChildProcess, Loss
from aerocues.progress import Activity
from aerocues.results.metrics import Row


class WorkerProcess(ChildProcess):
    """A process that evaluates units."""

    def __init__(
        self, number: int, context: Context, memory_limit_mb: int, *, pinned: bool
    ) -> None:
        self.number = number
        super().__init__(
            "aerocues.evaluation.worker",
            context,
            memory_limit_mb=memory_limit_mb,
            core=_core(number) if pinned else -1,
        )

    def begin(self, unit: Unit) -> None:
        self.send(unit)

    def rows(self) -> list[Row] | Loss:
        """The rows of the next pair of the unit, or how the worker was lost."""
        received: list[Row] | Loss = self.receive()
        return received

    def activity(self) -> Activity:
        call, seconds = self.doing()
        return Activity(self.number, call, seconds)


def _core(number: int) -> int:
    """A separate core for each worker, from the last core down; -1 if none can be chosen."""
    if not hasattr(os, "sched_getaffinity"):
        return -1
    cores = sorted(os.sched_getaffinity(0), reverse=True)
    return cores[number % len(cores)]
