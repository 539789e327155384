"""The default engine: worker processes on this machine, with limits of time and memory."""

from __future__ import annotations

import contextlib
from collections.abc import Generator, Iterator, Sequence
from dataclasses import dataclass

from aerocues.evaluation.engine import Engine, Finished
from aerocues.evaluation.unit import Context, Unit
from aerocues.evaluation.worker_pool import WorkerPool
from aerocues.progress import Watch


@dataclass(frozen=True)
class LocalEngine:
    """Worker processes on this machine.

    Parameters
    ----------
    workers : int
        Number of processes.
    timeout : float
        Limit of the CPU seconds of one stage call, and of the wall seconds that it may be idle.
    memory_limit_mb : int
        Memory of one worker.
    """

    workers: int
    timeout: float
    memory_limit_mb: int

    def _pool(self, context: Context) -> WorkerPool:
        return WorkerPool(context, self.workers, self.timeout, self.memory_limit_mb)

    def run(
        self, units: Sequence[Unit], context: Context, watch: Watch
    ) -> Generator[Finished, None, None]:
        """Run all units; see `Engine.run`."""
        with contextlib.closing(self._pool(context)) as pool:
            yield from pool.run(units, watch)

    @contextlib.contextmanager
    def standing(self, context: Context) -> Iterator[Engine]:
        """An engine whose workers, with their cached features, are kept between calls of `run`."""
        with contextlib.closing(self._pool(context)) as pool:
            yield _Standing(pool)


@dataclass(frozen=True)
class _Standing:
    """Workers for one context."""

    pool: WorkerPool

    def run(
        self, units: Sequence[Unit], context: Context, watch: Watch
    ) -> Generator[Finished, None, None]:
        """Run all units; `context` must be the context of the workers."""
        yield from self.pool.run(units, watch)
