"""The default engine: worker processes on this machine, watched for death, time and memory."""

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
        Processes at a time.
    timeout : float
        CPU seconds that one stage call may use, and wall seconds for which it may sit idle.
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
        """An engine whose workers, with the features that they hold, outlive a call of `run`."""
        with contextlib.closing(self._pool(context)) as pool:
            yield _Standing(pool)


@dataclass(frozen=True)
class _Standing:
    """Workers that serve one context."""

    pool: WorkerPool

    def run(
        self, units: Sequence[Unit], context: Context, watch: Watch
    ) -> Generator[Finished, None, None]:
        """Run all units; `context` is the one that the workers were started with."""
        yield from self.pool.run(units, watch)
