"""Standard error led elsewhere for a moment: libraries in C print to its descriptor, unasked."""

from __future__ import annotations

import contextlib
import os
import signal
import sys
import threading
from collections.abc import Iterator
from types import FrameType
from typing import IO

STANDARD_ERROR = 2
INTERRUPTING = ("SIGINT", "SIGTERM", "SIGHUP")
# The descriptor belongs to the whole process: two threads at once would each keep the other's.
_lock = threading.RLock()


def tell(text: str) -> None:
    """Write to standard error; wait while another thread leads it elsewhere."""
    with _lock:
        sys.stderr.write(text)
        sys.stderr.flush()


@contextlib.contextmanager
def standard_error_in(file: IO[bytes]) -> Iterator[None]:
    """Lead what is written to standard error, if there is one, into a file while the block runs."""
    with _lock, _interruptions_wait():
        try:
            before = os.dup(STANDARD_ERROR)
        except OSError:  # there is none
            before = None
        else:
            os.dup2(file.fileno(), STANDARD_ERROR)
        try:
            yield
        finally:
            if before is not None:
                os.dup2(before, STANDARD_ERROR)
                os.close(before)


@contextlib.contextmanager
def _interruptions_wait() -> Iterator[None]:
    """Handle signals after the block: an exception at the wrong moment would leave it as it is.

    Polars raises a `KeyboardInterrupt` of its own, and Python's comes before any clean-up.
    """
    if threading.current_thread() is not threading.main_thread():
        yield  # handlers run in the main thread only
        return
    waiting: list[tuple[int, FrameType | None]] = []
    handlers = {}
    try:
        for number in (getattr(signal, name) for name in INTERRUPTING if hasattr(signal, name)):
            handler = signal.getsignal(number)
            if callable(handler):
                handlers[number] = handler
                signal.signal(number, lambda *told: waiting.append(told))
        yield
    finally:
        for number, handler in handlers.items():
            signal.signal(number, handler)
        for told in waiting:
            handlers[told[0]](*told)
