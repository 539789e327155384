"""Worker processes and the current work of each."""

from __future__ import annotations

from collections.abc import Generator, Iterator, Sequence
from multiprocessing.connection import wait

from aerocues.evaluation.engine import Finished
from aerocues.evaluation.giving_up import settle_loss
from aerocues.evaluation.unit import Context, Unit
from aerocues.evaluation.unit_queue import UnitQueue
from aerocues.evaluation.worker_process import WorkerProcess
from aerocues.processes.child_process import Loss
from aerocues.progress import Activity, Watch
from aerocues.results.metrics import Row

POLL_SECONDS = 0.2


class WorkerPool:
    """Worker processes on this machine; see `LocalEngine` for the parameters."""

    def __init__(
        self, context: Context, workers: int, timeout: float, memory_limit_mb: int
    ) -> None:
        self._context = context
        self._workers = workers
        self._timeout = timeout
        self._memory_limit_mb = memory_limit_mb
        self._exclusive = context.protocol.timing == "exclusive"
        self._idle: list[WorkerProcess] = []
        self._busy: dict[WorkerProcess, Unit] = {}
        self._finished: dict[WorkerProcess, Unit] = {}

    def _fresh(self) -> WorkerProcess:
        used = {worker.number for worker in (*self._idle, *self._busy)}
        number = next(n for n in range(self._workers) if n not in used)
        return WorkerProcess(number, self._context, self._memory_limit_mb, pinned=self._exclusive)

    def run(self, units: Sequence[Unit], watch: Watch) -> Generator[Finished, None, None]:
        """Run all units; workers that are idle at the end are kept."""
        queue = UnitQueue(units, self._context.dataset)
        try:
            while queue or self._busy:
                self._fill(queue)
                watch(self._activities())
                for finished, remaining in self._collect():
                    queue.put_back(remaining)
                    if finished is not None:
                        yield finished
        finally:
            while self._busy:
                self._busy.popitem()[0].stop()

    def _fill(self, queue: UnitQueue) -> None:
        """Give the next unit to every idle worker."""
        while queue and len(self._busy) < self._workers:
            idle = self._idle.pop() if self._idle else None
            finished = self._finished.pop(idle, None) if idle else None
            unit = queue.take(finished, self._busy.values())
            if idle and self._needs_own_process(unit):
                idle.stop()
                idle = None
            worker = idle or self._fresh()
            worker.begin(unit)
            self._busy[worker] = unit

    def _needs_own_process(self, unit: Unit) -> bool:
        return unit.alone or self._context.methods.detectors[unit.detector].unstable

    def _activities(self) -> list[Activity]:
        return [worker.activity() for worker in sorted(self._busy, key=lambda w: w.number)]

    def _collect(self) -> Iterator[tuple[Finished | None, list[Unit]]]:
        """Collect finished units, and requeue the rest of units whose worker was lost."""
        ready = wait([worker.pipe for worker in self._busy], POLL_SECONDS)
        for worker in list(self._busy):
            if worker.pipe in ready:
                rows = worker.rows()
                if isinstance(rows, list):
                    yield self._advance(worker, rows), []
                    continue
                loss: Loss | None = rows
            else:
                loss = worker.overrun(self._timeout)
            if loss is not None:
                yield self._settle(worker, loss)

    def _advance(self, worker: WorkerProcess, rows: list[Row]) -> Finished:
        """Receive the rows of the next pair of a worker's unit."""
        unit = self._busy.pop(worker)
        done, rest = unit.parts(1)
        if rest.work:
            self._busy[worker] = rest
        else:
            self._retire(worker, unit)
        return Finished(done, rows)

    def _retire(self, worker: WorkerProcess, unit: Unit) -> None:
        if self._needs_own_process(unit):
            # Its memory may be corrupted: nothing else may be measured there.
            worker.stop()
        else:
            self._idle.append(worker)
            self._finished[worker] = unit

    def _settle(self, worker: WorkerProcess, loss: Loss) -> tuple[Finished | None, list[Unit]]:
        unit = self._busy.pop(worker)
        worker.stop()
        return settle_loss(self._context, unit, loss)

    def close(self) -> None:
        """End all workers."""
        while self._idle:
            self._idle.pop().stop()
