"""The process that evaluates units: ``python -m aerocues.evaluation.worker``.

It receives a context and then units over a pipe, and sends their rows back.
"""

from __future__ import annotations

from multiprocessing.connection import Connection

from aerocues.processes.child import run_child
from aerocues.processes.heartbeat import Heartbeat


def serve(pipe: Connection, heartbeat: Heartbeat) -> None:
    """Evaluate units until the parent closes the pipe."""
    # This import takes so long that the parent may die meanwhile; it is already being watched.
    from aerocues.evaluation.evaluator import Evaluator

    context = pipe.recv()
    evaluator = Evaluator(context, heartbeat.announce)
    pipe.send("ready")
    while True:
        try:
            unit = pipe.recv()
        except EOFError:
            return
        for rows in evaluator.evaluate(unit):
            heartbeat.announce(None)
            pipe.send(rows)


if __name__ == "__main__":
    run_child(serve)
