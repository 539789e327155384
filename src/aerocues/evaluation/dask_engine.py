"""Runs units on the workers of a Dask cluster; only the client writes the results folder."""

from __future__ import annotations

import contextlib
import time
import uuid
from collections import deque
from collections.abc import Generator, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from aerocues.arguments import seconds_of
from aerocues.defaults import CALL_TIMEOUT
from aerocues.errors import EngineError
from aerocues.evaluation.dask_losses import DaskLosses, call_of
from aerocues.evaluation.engine import Finished
from aerocues.evaluation.unit import Context, Unit
from aerocues.processes.limits import memory_mb
from aerocues.progress import Activity, Watch

if TYPE_CHECKING:
    from distributed import Client, Future

    from aerocues.evaluation.dask_worker import Measured, Report, UnitMeasurer

POLL_SECONDS = 0.1
SECONDS_BETWEEN_COUNTS = 2.0
# For results in transit: if a worker is lost with them, Dask measures the unit again.
RESULT_SECONDS = 10.0
# Enough that no worker waits for its next unit, but few enough to spare the cluster's memory.
UNITS_PER_THREAD = 2
FEWEST_UNITS = 8
RETRIES = 2
LONGEST_SECONDS = 30.0
AGAIN = "run the same command again: finished work is kept"


@dataclass(frozen=True)
class DaskEngine:
    """The workers of a Dask cluster, which may come and go.

    Parameters
    ----------
    client : distributed.Client
        From `dask_scheduler.connected`, or from any cluster that Dask supports, such as
        ``dask_jobqueue.SLURMCluster``.
    timeout : float or str
        CPU time that one call of a method may use, and wall time for which it may sit idle:
        seconds, or a text such as ``"5min"``.
    memory_limit : float or None
        Gigabytes of the process that measures a unit; by default 80 % of what a thread of the
        Dask worker has.
    resource : str or None
        Only workers that were started with this resource (``dask worker --resources NAME=1``)
        get units, to choose one kind of machine.
    longest_seconds : float
        A worker sends the rows of a unit after so long, or when the pair that it is at is
        finished; the rest of the unit goes to whichever worker is free.

    Raises
    ------
    ArgumentError
        If a limit makes no sense.
    """

    client: Client
    timeout: float | str = CALL_TIMEOUT
    memory_limit: float | None = None
    resource: str | None = None
    longest_seconds: float = LONGEST_SECONDS

    def __post_init__(self) -> None:
        self._limits()

    def _limits(self) -> tuple[float, int | None]:
        """Seconds and megabytes."""
        return seconds_of("timeout", self.timeout), memory_mb(self.memory_limit)

    @property
    def threads(self) -> int:
        """Number of units that the eligible workers can measure at a time."""
        if self.resource is None:
            return sum(self.client.nthreads().values())
        workers = self.client.scheduler_info(n_workers=-1)["workers"].values()
        return sum(
            min(worker["nthreads"], int(worker["resources"].get(self.resource, 0)))
            for worker in workers
        )

    @property
    def worker_wanted(self) -> str:
        """``worker``, or ``worker with the resource NAME``."""
        return f"worker with the resource {self.resource}" if self.resource else "worker"

    @property
    def dashboard(self) -> str | None:
        """Address of the scheduler's dashboard; None if it has no dashboard."""
        try:
            link: str | None = self.client.dashboard_link
        except KeyError:  # the key of the dashboard in the scheduler's list of services
            return None
        return link

    def run(
        self, units: Sequence[Unit], context: Context, watch: Watch
    ) -> Generator[Finished, None, None]:
        """Run all units; see `Engine.run`.

        Raises
        ------
        EngineError
            If the scheduler is lost, or a worker has other versions or other images.
        """
        from aerocues.evaluation.dask_worker import UnitMeasurer

        name = f"aerocues-{uuid.uuid4().hex[:12]}"
        measurer = UnitMeasurer(name, context, *self._limits(), self.longest_seconds)
        dispatch = _Dispatch(self, name, context, units)
        try:
            self._prepare_workers(measurer)
            self.client.subscribe_topic(name, dispatch.hear)
            yield from dispatch.run(watch)
        finally:
            with contextlib.suppress(OSError, RuntimeError, ValueError):
                # A lost scheduler needs no cleaning up.
                dispatch.cancel()
                self.client.unsubscribe_topic(name)
                self.client.unregister_worker_plugin(name)

    def _prepare_workers(self, measurer: UnitMeasurer) -> None:
        try:
            self.client.register_plugin(measurer, name=measurer.name)
        except ImportError as error:
            raise EngineError(
                f"the cluster lacks a package that the run needs ({error}); install aerocues[dask] "
                "and your plug-ins in the versions of this machine on all its machines"
            ) from error
        except OSError as error:
            raise EngineError(
                f"a worker was lost at the start of the run ({error}); {AGAIN}"
            ) from error


@dataclass(frozen=True)
class _Heard:
    """The latest report about a unit, and its time."""

    report: Report
    time: float


class _Dispatch:
    """Submits units to the cluster, a limited number at a time, and collects the outcomes.

    Parameters
    ----------
    engine : DaskEngine
    name : str
        Name of the run.
    context : Context
    units : sequence of Unit
    """

    def __init__(
        self, engine: DaskEngine, name: str, context: Context, units: Sequence[Unit]
    ) -> None:
        self._engine = engine
        self._client = engine.client
        self._resources = {engine.resource: 1} if engine.resource else None
        self._name = name
        self._queue = deque(units)
        self._given: dict[str, tuple[Future[Measured], Unit]] = {}
        self._heard: dict[str, _Heard] = {}
        self._numbers: dict[str, int] = {}
        self._count = 0
        self._room = FEWEST_UNITS
        self._counted = float("-inf")
        self._without_worker_since: float | None = None
        self._losses = DaskLosses(context)

    def hear(self, event: tuple[float, Report]) -> None:
        """Handle the report of a worker."""
        report = event[1]
        if report["key"] not in self._given:
            return  # it was in transit when the rows of the unit arrived
        self._numbers.setdefault(report["worker"], len(self._numbers))
        self._losses.hear(report)
        self._heard[report["key"]] = _Heard(report, time.monotonic())

    def run(self, watch: Watch) -> Iterator[Finished]:
        """Run all units."""
        while self._queue or self._given:
            self._require_scheduler()
            self._count_threads()
            self._fill()
            watch(self._activities())
            ended = [key for key, (future, _) in self._given.items() if future.done()]
            for key in ended:
                yield from self._take(key)
            if not ended:
                time.sleep(POLL_SECONDS)

    def cancel(self) -> None:
        """Cancel what is not finished."""
        self._client.cancel([future for future, _ in self._given.values()])
        self._given.clear()

    def _require_scheduler(self) -> None:
        if self._client.status != "running":
            raise EngineError(f"the Dask scheduler was lost; start it and {AGAIN}")

    def _count_threads(self) -> None:
        now = time.monotonic()
        if now - self._counted <= SECONDS_BETWEEN_COUNTS:
            return
        self._counted = now
        with contextlib.suppress(OSError):  # a lost scheduler is reported elsewhere
            threads = self._engine.threads
            self._room = max(UNITS_PER_THREAD * threads, FEWEST_UNITS)
            since = now if self._without_worker_since is None else self._without_worker_since
            self._without_worker_since = None if threads else since

    def _fill(self) -> None:
        from aerocues.evaluation.dask_worker import measure

        while self._queue and len(self._given) < self._room:
            unit = self._queue.popleft()
            key = f"{unit.detector}-{self._count}-{self._name}"
            self._count += 1
            future = self._client.submit(
                measure,
                self._name,
                key,
                unit,
                key=key,
                pure=False,
                retries=RETRIES,
                resources=self._resources,
            )
            self._given[key] = future, unit

    def _activities(self) -> list[Activity]:
        now = time.monotonic()
        if (since := self._without_worker_since) is not None:
            return [Activity(0, None, now - since, f"a {self._engine.worker_wanted}")]
        heard = [found for key in self._given if (found := self._heard.get(key))]
        activities = [
            Activity(
                self._numbers[each.report["worker"]],
                call_of(each.report),
                each.report["seconds"] + now - each.time,
            )
            for each in heard
        ]
        return sorted(activities, key=lambda activity: activity.worker)

    def _take(self, key: str) -> Iterator[Finished]:
        """The outcome of a unit that Dask has finished; work to retry is queued."""
        from distributed import CancelledError, KilledWorker

        future, unit = self._given[key]
        try:
            measured = future.result(timeout=RESULT_SECONDS)
        except TimeoutError:
            return  # it is measured again
        except CancelledError:
            self._require_scheduler()
            self._queue.appendleft(unit)  # the workers were restarted
        except KilledWorker as error:
            heard = self._heard.get(key)
            report = heard.report if heard else None
            given_up, remaining = self._losses.settle(unit, report, error)
            self._queue.extendleft(reversed(remaining))
            if given_up is not None:
                yield given_up
        else:
            if measured.left is not None:
                self._queue.appendleft(measured.left)
            yield from measured.finished
        del self._given[key]
        self._heard.pop(key, None)
