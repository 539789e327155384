"""A worker process as its parent sees it."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from multiprocessing import Pipe
from pathlib import Path

import psutil

from aerocues.errors import EngineError
from aerocues.evaluation.engine import Activity
from aerocues.evaluation.heartbeat import Heartbeat
from aerocues.evaluation.metrics import Row
from aerocues.evaluation.unit import Context, StageCall, Unit

START_SECONDS = 120.0
LAST_WORDS = 300
# A process that computes uses far more of the wall time than this, on any crowded machine.
IDLE_SHARE = 0.01


@dataclass(frozen=True)
class Loss:
    """How a worker was lost: the status for the guilty rows, why, and the call that it was in."""

    status: str
    message: str
    call: StageCall | None


class WorkerProcess:
    """Starts, feeds, watches and ends one worker."""

    def __init__(
        self, number: int, context: Context, memory_limit_mb: int, *, pinned: bool
    ) -> None:
        self.number = number
        self._memory_limit_mb = memory_limit_mb
        self._folder = tempfile.TemporaryDirectory(prefix="aerocues-worker-")
        page = Path(self._folder.name) / "heartbeat"
        page.touch()
        self._heartbeat = Heartbeat(page)
        self._errors = (Path(self._folder.name) / "stderr").open("w+b")
        self.pipe, theirs = Pipe()
        core = _core(number) if pinned else -1
        arguments = [
            str(value) for value in (theirs.fileno(), page, memory_limit_mb, core, os.getpid())
        ]
        self._process = subprocess.Popen(
            [sys.executable, "-m", "aerocues.evaluation.worker", *arguments],
            pass_fds=[theirs.fileno()],
            stdin=subprocess.DEVNULL,
            stdout=self._errors,
            stderr=self._errors,
            # Whatever the parent can import, plug-ins above all; "" stands for where it is now.
            env={
                **os.environ,
                "PYTHONPATH": os.pathsep.join(path or str(Path.cwd()) for path in sys.path),
            },
        )
        theirs.close()
        self._system = psutil.Process(self._process.pid)
        self._await_start(context)

    def _await_start(self, context: Context) -> None:
        try:
            self.pipe.send(context)
            if self.pipe.poll(START_SECONDS) and self.pipe.recv() == "ready":
                return
        except (EOFError, OSError):
            pass  # told below, with the worker's last words
        except BaseException:  # an interruption: nobody else knows this process yet
            self.stop()
            raise
        words = self._last_words()
        self.stop()
        raise EngineError(
            f"a worker process could not start: {words or 'no message'}; check --memory-limit and "
            "that this Python can import aerocues"
        )

    def begin(self, unit: Unit) -> None:
        with contextlib.suppress(BrokenPipeError):  # a dead worker is found when it is watched
            self.pipe.send(unit)

    def receive(self) -> list[Row] | Loss:
        """The rows of the unit, or how the worker was lost."""
        try:
            rows: list[Row] = self.pipe.recv()
        except (EOFError, OSError):
            return self._died()
        return rows

    def _died(self) -> Loss:
        code = self._process.wait()
        call = self._call()
        how = f"signal {signal.Signals(-code).name}" if code < 0 else f"exit code {code}"
        words = self._last_words()
        status = "out_of_memory" if "MemoryError" in words or "bad_alloc" in words else "crashed"
        message = f"the process died ({how}) in {call or 'no stage'}"
        return Loss(status, f"{message}: {words}" if words else message, call)

    def overrun(self, timeout: float) -> Loss | None:
        """Whether the worker uses more time or memory than it may; it is then to be ended."""
        beat = self._heartbeat.read()
        if beat is None or beat.call is None:
            return None
        try:
            times = self._system.cpu_times()
            memory = self._system.memory_info().rss / 2**20
        except psutil.Error:
            return None  # it has just died, which its pipe will tell
        if memory > self._memory_limit_mb:
            return Loss(
                "out_of_memory",
                f"{beat.call} took {memory:.0f} MB, more than the limit of "
                f"{self._memory_limit_mb} MB (--memory-limit)",
                beat.call,
            )
        used = times.user + times.system - beat.cpu_seconds
        elapsed = time.monotonic() - beat.wall_time
        if used > timeout:
            return Loss(
                "timeout",
                f"{beat.call} used more than {timeout:g} CPU seconds (--timeout)",
                beat.call,
            )
        if elapsed > timeout and used < IDLE_SHARE * elapsed:
            return Loss(
                "timeout", f"{beat.call} sat idle for {timeout:g} seconds (--timeout)", beat.call
            )
        return None

    def activity(self) -> Activity:
        beat = self._heartbeat.read()
        if beat is None or beat.call is None:
            return Activity(self.number, None, 0.0)
        return Activity(self.number, beat.call, time.monotonic() - beat.wall_time)

    def _call(self) -> StageCall | None:
        beat = self._heartbeat.read()
        return beat.call if beat else None

    def _last_words(self) -> str:
        """The end of what the process wrote to its standard error, in one line."""
        self._errors.seek(0)
        text = self._errors.read().decode(errors="replace")
        return " ".join(text.split())[-LAST_WORDS:]

    def stop(self) -> None:
        """End the process at once; nothing that it holds is worth waiting for."""
        self.pipe.close()
        self._process.kill()
        self._process.wait()
        self._heartbeat.close()
        self._errors.close()
        self._folder.cleanup()


def _core(number: int) -> int:
    """A core of its own for each worker, from the last one down; -1 where none can be chosen."""
    if not hasattr(os, "sched_getaffinity"):
        return -1
    cores = sorted(os.sched_getaffinity(0), reverse=True)
    return cores[number % len(cores)]
