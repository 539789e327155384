"""A Dask cluster of separate processes on this machine."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path

from tests.waiting import wait_until


@dataclass
class Cluster:
    """A scheduler and its workers; `environment` is added to that of each process."""

    folder: Path
    environment: dict[str, str] = field(default_factory=dict)
    address: str = ""
    _scheduler: subprocess.Popen[bytes] | None = None
    workers: list[subprocess.Popen[bytes]] = field(default_factory=list)

    def start(self) -> None:
        """Start the scheduler on a free port."""
        file = self.folder / "scheduler.json"
        self._scheduler = self._process(
            "dask_scheduler",
            *("--host", "127.0.0.1", "--port", "0", "--scheduler-file", str(file)),
            *("--dashboard-address", "127.0.0.1:0"),
        )
        scheduler = self._scheduler
        wait_until(lambda: scheduler.poll() is not None or (file.is_file() and file.stat().st_size))
        self.address = json.loads(file.read_text())["address"]

    def add_worker(self, *options: str) -> subprocess.Popen[bytes]:
        """Start a worker with one thread, which joins in a while."""
        worker = self._process(
            "dask_worker",
            self.address,
            *("--nthreads", "1", "--no-dashboard", "--host", "127.0.0.1"),
            *("--local-directory", str(self.folder)),
            *(options or ("--no-nanny",)),
        )
        self.workers.append(worker)
        return worker

    def _process(self, command: str, *arguments: str) -> subprocess.Popen[bytes]:
        return subprocess.Popen(
            [sys.executable, "-m", f"distributed.cli.{command}", *arguments],
            env={
                **os.environ,
                "PYTHONPATH": os.pathsep.join(filter(None, sys.path)),
                "AEROCUES_TEST_RUN": str(self.folder),
                "TMPDIR": str(self.folder),
                **self.environment,
            },
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )

    def kill_scheduler(self) -> None:
        assert self._scheduler is not None
        _kill(self._scheduler)

    def stop(self) -> None:
        """End all processes, those that workers started included."""
        for process in (*self.workers, self._scheduler):
            if process is not None:
                _kill(process)


def _kill(process: subprocess.Popen[bytes]) -> None:
    """End a process and what it started."""
    with contextlib.suppress(ProcessLookupError):  # it has ended before
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()
