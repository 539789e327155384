"""The task of a Dask worker in a run: it measures units in its own worker processes.

A method that crashes, hangs or uses too much memory then has the same effect as on a single
machine, and does not kill the Dask worker.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import tempfile
import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TypedDict

from distributed import Worker, WorkerPlugin, get_worker

from aerocues.errors import EngineError, ImageError
from aerocues.evaluation.engine import Finished
from aerocues.evaluation.unit import Context, Unit
from aerocues.evaluation.worker_pool import WorkerPool
from aerocues.file_locks import try_lock
from aerocues.processes.memory import memory_bytes
from aerocues.progress import Activity, Watch
from aerocues.results.versions import machine_name, software_versions

# Software that affects rows: rows are identified by the versions of the run, so that other versions
# must not be mixed with them.
SAME_VERSIONS = ("aerocues", "opencv")
# A process waits this long for the next unit, which saves its start; then its memory is released.
IDLE_SECONDS = 60.0
# Shorter intervals keep the display more current, and cost messages to the scheduler.
SECONDS_BETWEEN_REPORTS = 1.0
# Between attempts to get the lock of a machine: longer ones leave it idle between two measurements.
SECONDS_BETWEEN_TRIES = 0.1
# Share of the memory of a Dask worker for its processes; the rest is for the worker itself.
MEMORY_SHARE = 0.8


class Report(TypedDict):
    """A periodic report of a worker about a unit: its current call, as a dictionary."""

    key: str
    worker: str
    machine: str
    call: dict[str, object] | None
    seconds: float


@dataclass(frozen=True)
class Measured:
    """The finished pairs of a unit, and the remaining part."""

    finished: list[Finished]
    left: Unit | None


class UnitMeasurer(WorkerPlugin):
    """A plug-in on every worker of a cluster, including late ones, for the duration of a run.

    Parameters
    ----------
    name : str
        Name of the run, and of the topic of its reports.
    context : Context
    timeout : float
        See `LocalEngine`.
    memory_limit_mb : int or None
        Memory of one process; by default a share of the memory of the Dask worker.
    longest_seconds : float
        After this time no further pair is started; the rest of the unit goes back to the run.
    """

    def __init__(
        self,
        name: str,
        context: Context,
        timeout: float,
        memory_limit_mb: int | None,
        longest_seconds: float,
    ) -> None:
        self.name = name
        self._context = context
        self._timeout = timeout
        self._memory_limit_mb = memory_limit_mb
        self._longest_seconds = longest_seconds
        self._versions = software_versions()
        self._image_keys = {
            image.name: image.source.content_key() for image in context.dataset.images
        }

    def setup(self, worker: Worker) -> None:
        self._worker = worker
        folder = self._context.features
        # For all workers of this machine: they have scratch folders side by side.
        self._references = Path(worker.local_directory).parent / f"{self.name}-references"
        self._context = replace(
            self._context,
            machine=machine_name(),
            features=folder if folder and folder.is_dir() else None,  # processes must not be shared
            references=self._references,
        )
        self._memory = self._memory_limit_mb or _memory_of(worker)
        self._different = _different_versions(self._versions)
        self._checked: set[str] = set()
        self._ending = threading.Event()
        self._lock = threading.Lock()
        self._idle: list[WorkerPool] = []
        self._countdown = threading.Timer(0.0, self._end_idle)

    def teardown(self, worker: Worker) -> None:
        self._ending.set()
        self._end_idle()
        shutil.rmtree(self._references, ignore_errors=True)

    def measure(self, key: str, unit: Unit) -> Measured:
        """Measure a unit, or as many of its pairs as the time allows.

        Raises
        ------
        EngineError
            If this worker has other versions or images, or cannot start a process.
        """
        if self._different:
            raise EngineError(
                f"the worker {self._worker.address} has {self._different}; install the "
                "same versions on all machines of the cluster"
            )
        with self._turn():
            self._check_images(unit)
            with self._pool() as pool:
                return self._measure_pairs(pool, unit, _Reporter(self._worker, self, key))

    def _measure_pairs(self, pool: WorkerPool, unit: Unit, watch: Watch) -> Measured:
        finished: list[Finished] = []
        end = time.monotonic() + self._longest_seconds
        while True:
            pair, unit = unit.parts(1)  # the process keeps the features for the next pair
            finished += pool.run([pair], watch)
            if not unit.work or time.monotonic() >= end:
                return Measured(finished, unit if unit.work else None)

    def check(self) -> None:
        """End running processes when the run is over.

        Raises
        ------
        EngineError
        """
        if self._ending.is_set():
            raise EngineError("the run is over")

    @property
    def machine(self) -> str:
        return self._context.machine

    @contextlib.contextmanager
    def _turn(self) -> Iterator[None]:
        """Wait until nothing else is measured on this machine, if the timing requires that."""
        if self._context.protocol.timing != "exclusive":
            yield
            return
        user = os.getuid() if hasattr(os, "getuid") else "user"
        path = Path(tempfile.gettempdir()) / f"aerocues-exclusive-{user}.lock"
        with path.open("w") as file:
            self.check()
            while not try_lock(file):
                time.sleep(SECONDS_BETWEEN_TRIES)
                self.check()
            yield

    @contextlib.contextmanager
    def _pool(self) -> Iterator[WorkerPool]:
        """An idle process or a new one; a Dask worker with several threads has several."""
        with self._lock:
            self._countdown.cancel()
            idle = self._idle.pop() if self._idle else None
        pool = idle or WorkerPool(self._context, 1, self._timeout, self._memory)
        try:
            yield pool
        except BaseException:
            pool.close()
            raise
        with self._lock:
            self._idle.append(pool)
            self._countdown.cancel()
            self._countdown = threading.Timer(IDLE_SECONDS, self._end_idle)
            self._countdown.daemon = True
            self._countdown.start()
        if self._ending.is_set():
            self._end_idle()

    def _end_idle(self) -> None:
        with self._lock:
            self._countdown.cancel()
            while self._idle:
                self._idle.pop().close()

    def _check_images(self, unit: Unit) -> None:
        """Check that the images of a unit are identical to those of the run.

        Raises
        ------
        EngineError
        """
        pairs = [self._context.dataset.pair(work.pair) for work in unit.work]
        names = {name for pair in pairs for name in (pair.image_1, pair.image_2)}
        for name in sorted(names - self._checked):
            try:
                same = (
                    self._context.dataset.image(name).source.content_key() == self._image_keys[name]
                )
            except ImageError as error:
                raise EngineError(
                    f"the worker {self._worker.address} cannot read an image of the run: "
                    f"{error}; mount the folder of the images there under the same path"
                ) from error
            if not same:
                raise EngineError(
                    f"the image {name} of the worker {self._worker.address} differs from that of "
                    "the run; "
                    "mount the folder of the images there under the same path"
                )
            self._checked.add(name)


class _Reporter:
    """Reports to the run what the process is doing, and to the process when the run is over."""

    def __init__(self, worker: Worker, measurer: UnitMeasurer, key: str) -> None:
        self._worker = worker
        self._measurer = measurer
        self._key = key
        self._told = float("-inf")
        self._has_called = False

    def __call__(self, activities: Sequence[Activity]) -> None:
        self._measurer.check()
        if not activities:
            return
        activity = activities[0]
        now = time.monotonic()
        is_first_call = activity.call is not None and not self._has_called
        if now - self._told < SECONDS_BETWEEN_REPORTS and not is_first_call:
            return
        self._told = now
        self._has_called |= is_first_call
        report = Report(
            key=self._key,
            worker=self._worker.address,
            machine=self._measurer.machine,
            call=asdict(activity.call) if activity.call else None,
            seconds=activity.seconds,
        )
        self._worker.log_event(self._measurer.name, report)


def measure(name: str, key: str, unit: Unit) -> Measured:
    """The task: measure a unit of the run `name` on the worker that executes this."""
    measurer = get_worker().plugins.get(name)
    if not isinstance(measurer, UnitMeasurer):
        raise EngineError(
            f"the worker {get_worker().address} does not know the run; run the same command again"
        )
    return measurer.measure(key, unit)


def _memory_of(worker: Worker) -> int:
    """MB for one process, from the limit of the Dask worker or its share of the machine."""
    threads = worker.state.nthreads
    total = memory_bytes()
    share = int(total * min(1.0, threads / (os.cpu_count() or 1)))
    return int(MEMORY_SHARE * (worker.memory_manager.memory_limit or share) / threads / 2**20)


def _different_versions(wanted: Mapping[str, str]) -> str:
    """Differences to the versions of the run that would change rows; empty if there are none.

    Rows are identified by the versions of the run, so rows of other versions must not be mixed in.
    """
    here = software_versions()
    return " and ".join(
        f"{name} {here.get(name)}, the run {wanted.get(name)}"
        for name in SAME_VERSIONS
        if here.get(name) != wanted.get(name)
    )
