"""The process that repeats measurements: ``python -m aerocues.report.drawing``.

It receives a context and then pairs and combinations over a pipe, and sends the matches back. Some
methods crash on some images; a report is not to be lost by that.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
from multiprocessing.connection import Connection

PARENT_CHECK_SECONDS = 0.5


def _end_with_parent(parent: int) -> None:
    while os.getppid() == parent:
        time.sleep(PARENT_CHECK_SECONDS)
    os._exit(1)


def serve(pipe: Connection) -> None:
    """Draw until the parent closes the pipe."""
    from aerocues.report.drawn_matches import Drawer

    drawer = Drawer(pipe.recv())
    while True:
        try:
            pair, combination = pipe.recv()
        except EOFError:
            return
        pipe.send(drawer.draw(pair, combination))


def main() -> None:
    """Entry point; arguments are the file descriptor of the pipe and the parent's process id."""
    descriptor, parent = (int(argument) for argument in sys.argv[1:])
    # Ctrl-C reaches the whole process group; the parent decides when this one ends.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, args=[parent], daemon=True).start()
    with Connection(descriptor) as pipe:
        serve(pipe)


if __name__ == "__main__":
    main()
