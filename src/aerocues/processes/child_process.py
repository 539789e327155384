"""A process that does work which may kill it, as its parent sees it."""

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
from typing import Any

import psutil

from aerocues.errors import EngineError
from aerocues.processes.call import StageCall
from aerocues.processes.heartbeat import Heartbeat
from aerocues.processes.inherited_pipe import handed_over, interpreter
from aerocues.scratch_folders import remove_left_over, scratch_prefix

START_SECONDS = 120.0
LAST_WORDS = 300
# Products of matrices and methods in Rust would otherwise take every core in every process.
ONE_THREAD = dict.fromkeys(
    ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "RAYON_NUM_THREADS"), "1"
)
# A process that computes uses far more of the wall time than this, on any crowded machine.
IDLE_SHARE = 0.01


@dataclass(frozen=True)
class Loss:
    """How a process was lost: the status for the guilty rows, why, and the call that it was in."""

    status: str
    message: str
    call: StageCall | None


class ChildProcess:
    """Starts, feeds, watches and ends one process.

    Parameters
    ----------
    module : str
        What is run: a module that calls `child.run_child`.
    start : object
        What it is sent first; it answers ``"ready"``.
    memory_limit_mb : int
    core : int
        The core to stay on; -1 for any.

    Raises
    ------
    EngineError
        If it cannot be started.
    """

    def __init__(
        self,
        module: str,
        start: object,
        *,
        memory_limit_mb: int,
        core: int = -1,
    ) -> None:
        self._memory_limit_mb = memory_limit_mb
        remove_left_over()
        self._folder = tempfile.TemporaryDirectory(
            prefix=scratch_prefix("worker"), ignore_cleanup_errors=True
        )
        page = Path(self._folder.name) / "heartbeat"
        page.touch()
        self._heartbeat = Heartbeat(page)
        self._errors = (Path(self._folder.name) / "stderr").open("w+b")
        self.pipe, theirs = Pipe()
        arguments = [
            str(value) for value in (theirs.fileno(), page, memory_limit_mb, core, os.getpid())
        ]
        program, environment = interpreter()
        self._process = subprocess.Popen(
            [program, "-m", module, *arguments],
            stdin=subprocess.DEVNULL,
            stdout=self._errors,
            stderr=self._errors,
            # Whatever the parent can import, plug-ins above all; "" stands for where it is now.
            env={
                **os.environ,
                **ONE_THREAD,
                **environment,
                "PYTHONPATH": os.pathsep.join(path or str(Path.cwd()) for path in sys.path),
            },
            **handed_over(theirs),
        )
        theirs.close()
        self._system = psutil.Process(self._process.pid)
        self._began = time.monotonic()
        self._await_start(start)

    def _await_start(self, start: object) -> None:
        try:
            self.pipe.send(start)
            if self.pipe.poll(START_SECONDS) and self.pipe.recv() == "ready":
                return
        except (EOFError, OSError):
            pass  # told below, with the worker's last words
        except BaseException:  # an interruption: nobody else knows this process yet
            self.stop()
            raise
        lines = self._written().splitlines()
        self.stop()
        # Of a traceback the last line says what happened; where, is of no use to who reads it.
        raise EngineError(
            f"a worker process could not start: {lines[-1] if lines else 'no message'}; check "
            "`memory_limit` and that this Python can import aerocues"
        )

    def send(self, work: object) -> None:
        with contextlib.suppress(BrokenPipeError):  # a dead process is found when it is watched
            self.pipe.send(work)

    def receive(self) -> Any:
        """What it sends next, or the `Loss` if it died."""
        try:
            return self.pipe.recv()
        except (EOFError, OSError):
            return self._died()

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
                f"{self._memory_limit_mb} MB",
                beat.call,
            )
        used = times.user + times.system - beat.cpu_seconds
        elapsed = time.monotonic() - beat.wall_time
        if used > timeout:
            return Loss(
                "timeout",
                f"{beat.call} used more than {timeout:g} CPU seconds",
                beat.call,
            )
        if elapsed > timeout and used < IDLE_SHARE * elapsed:
            return Loss(
                "timeout",
                f"{beat.call} sat idle for {timeout:g} seconds",
                beat.call,
            )
        return None

    def doing(self) -> tuple[StageCall | None, float]:
        """The call that it is in, and for how many seconds."""
        beat = self._heartbeat.read()
        if beat is None or beat.call is None:
            return None, 0.0
        return beat.call, time.monotonic() - beat.wall_time

    @property
    def wall_seconds(self) -> float:
        """Since it was started."""
        return time.monotonic() - self._began

    @property
    def core_share(self) -> float:
        """CPU seconds over wall seconds since it was started; 0 where it has died."""
        try:
            used = self._system.cpu_times()
        except psutil.Error:
            return 0.0
        return (used.user + used.system) / max(self.wall_seconds, 1.0)

    def _call(self) -> StageCall | None:
        beat = self._heartbeat.read()
        return beat.call if beat else None

    def _last_words(self) -> str:
        """The end of what the process wrote to its standard error, in one line."""
        return " ".join(self._written().split())[-LAST_WORDS:]

    def _written(self) -> str:
        self._errors.seek(0)
        return self._errors.read().decode(errors="replace").strip()

    def stop(self, patience: float = 0.0) -> None:
        """End the process: at once, or where it has nothing left to do, by itself.

        Parameters
        ----------
        patience : float
            Seconds that it may take to end by itself.
        """
        self.pipe.close()
        if patience:
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._process.wait(patience)
        self._process.kill()
        self._process.wait()
        self._heartbeat.close()
        self._errors.close()
        self._folder.cleanup()
