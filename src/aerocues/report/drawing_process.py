"""The parent's side of the process that repeats measurements."""

from __future__ import annotations

from types import TracebackType

from aerocues.evaluation.unit import Context
from aerocues.methods.combination import Combination
from aerocues.processes.child_process import ChildProcess, Loss
from aerocues.processes.limits import share_of_memory
from aerocues.report.drawn_matches import DrawnMatches

SECONDS_TO_END = 5.0


class DrawingProcess:
    """Repeats measurements in a separate process, which is restarted if it dies.

    Parameters
    ----------
    context : Context
    """

    def __init__(self, context: Context) -> None:
        self._context = context
        self._child: ChildProcess | None = None

    def __enter__(self) -> DrawingProcess:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._stop(0.0 if error else SECONDS_TO_END)

    def draw(self, pair_index: int, combination: Combination, timeout: float) -> DrawnMatches | str:
        """The matches of a combination on a pair, or the reason why they cannot be had.

        Parameters
        ----------
        pair_index : int
        combination : Combination
        timeout : float
            Wall seconds.
        """
        child = self._child = self._child or self._start()
        child.send((pair_index, combination))
        reason = f"it took more than {timeout:.0f} s"
        if child.pipe.poll(timeout):
            found: DrawnMatches | str | Loss = child.receive()
            if not isinstance(found, Loss):
                return found
            reason = "the process died while drawing it"
        self._stop()
        return reason

    def _start(self) -> ChildProcess:
        memory = share_of_memory(1)
        return ChildProcess("aerocues.report.drawing", self._context, memory_limit_mb=memory)

    def _stop(self, patience: float = 0.0) -> None:
        if self._child is not None:
            self._child.stop(patience)
        self._child = None
