"""The process that repeats measurements: ``python -m aerocues.report.drawing``.

It receives a context, then pairs and combinations over a pipe, and sends the matches back. Some
methods crash on some images; in a separate process the report survives.
"""

from __future__ import annotations

from multiprocessing.connection import Connection

from aerocues.processes.child import run_child
from aerocues.processes.heartbeat import Heartbeat


def serve(pipe: Connection, heartbeat: Heartbeat) -> None:
    """Answer requests until the parent closes the pipe."""
    from aerocues.report.drawn_matches import Drawer

    drawer = Drawer(pipe.recv())
    pipe.send("ready")
    while True:
        try:
            pair, combination = pipe.recv()
        except EOFError:
            return
        pipe.send(drawer.draw(pair, combination))


if __name__ == "__main__":
    run_child(serve)
