"""The process that repeats measurements, as its parent sees it."""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from pathlib import Path
from types import TracebackType

from aerocues.evaluation.unit import Context
from aerocues.methods.combination import Combination
from aerocues.report.drawn_matches import DrawnMatches

SECONDS_TO_END = 5.0


class DrawingProcess:
    """Repeats measurements in a process of its own, started anew when it was lost.

    Parameters
    ----------
    context : Context
    """

    def __init__(self, context: Context) -> None:
        self._context = context
        self._process: subprocess.Popen[bytes] | None = None
        self._pipe: Connection | None = None

    def __enter__(self) -> DrawingProcess:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._stop(patience=0 if error else SECONDS_TO_END)

    def draw(self, pair_index: int, combination: Combination, timeout: float) -> DrawnMatches | str:
        """The matches of a combination on a pair, or why there are none.

        Parameters
        ----------
        pair_index : int
        combination : Combination
        timeout : float
            Wall seconds.
        """
        pipe = self._pipe or self._start()
        try:
            pipe.send((pair_index, combination))
            if pipe.poll(timeout):
                found: DrawnMatches | str = pipe.recv()
                return found
            reason = f"it took more than {timeout:.0f} s"
        except (EOFError, OSError):
            reason = "the process died in it"
        self._stop()
        return reason

    def _start(self) -> Connection:
        self._pipe, theirs = Pipe()
        with theirs:
            self._process = subprocess.Popen(
                [
                    *(sys.executable, "-m", "aerocues.report.drawing"),
                    *(str(theirs.fileno()), str(os.getpid())),
                ],
                pass_fds=[theirs.fileno()],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                # Whatever this process can import, plug-ins above all.
                env={
                    **os.environ,
                    "PYTHONPATH": os.pathsep.join(path or str(Path.cwd()) for path in sys.path),
                },
            )
        self._pipe.send(self._context)
        return self._pipe

    def _stop(self, patience: float = 0) -> None:
        if self._pipe is not None:
            self._pipe.close()
        if self._process is not None:
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._process.wait(patience)  # it ends by itself where nothing is left to do
            self._process.kill()
            self._process.wait()
        self._pipe = self._process = None
