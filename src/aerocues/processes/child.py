"""A process that does work for a parent: what every module that `ChildProcess` runs has in common.

It is started anew rather than forked, so that callers need no ``__main__`` guard and threads of
theirs do no harm.
"""

from __future__ import annotations

import os
import shutil
import signal
import sys
import threading
import time
from collections.abc import Callable
from multiprocessing.connection import Connection
from pathlib import Path

from aerocues.processes.heartbeat import Heartbeat
from aerocues.processes.inherited_pipe import taken_over

PARENT_CHECK_SECONDS = 0.5


def _limit_memory(megabytes: int) -> None:
    """Make allocations beyond the limit fail, so that they are reported rather than killed."""
    try:
        import resource
    except ImportError:
        return  # no such limit on this system; the parent watches the resident set anyway
    limit = megabytes * 1024 * 1024
    resource.setrlimit(resource.RLIMIT_DATA, (limit, limit))


def _end_with_parent(parent: int, folder: Path) -> None:
    """End this process soon after its parent, however that ended: nobody waits for the rows."""
    while os.getppid() == parent:
        time.sleep(PARENT_CHECK_SECONDS)
    shutil.rmtree(folder, ignore_errors=True)  # else the parent would have done it
    os._exit(1)


def run_child(serve: Callable[[Connection, Heartbeat], None]) -> None:
    """Do the work of a module that `ChildProcess` runs, until `serve` returns.

    The program's arguments are the file descriptor of the pipe, the heartbeat file, the memory
    limit in MB, the core to stay on or -1, and the parent's process id.
    """
    descriptor, page, megabytes, core, parent = sys.argv[1:]
    # Both reach whole process groups; the parent decides when a worker ends, or its own end does.
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.SIG_IGN)
    if int(core) >= 0 and hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {int(core)})
    _limit_memory(int(megabytes))
    watch = threading.Thread(
        target=_end_with_parent, args=[int(parent), Path(page).parent], daemon=True
    )
    watch.start()
    try:
        with taken_over(int(descriptor)) as pipe:
            serve(pipe, Heartbeat(Path(page)))
    finally:
        shutil.rmtree(Path(page).parent, ignore_errors=True)
