"""A pipe that a new process takes over, as each system does that."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Mapping
from multiprocessing import connection
from multiprocessing.connection import Connection
from typing import Any


def handed_over(pipe: Connection) -> Mapping[str, Any]:
    """What `subprocess.Popen` is told so that the process gets the pipe under its number."""
    if sys.platform != "win32":
        return {"pass_fds": [pipe.fileno()]}
    os.set_handle_inheritable(pipe.fileno(), True)
    startup = subprocess.STARTUPINFO(lpAttributeList={"handle_list": [pipe.fileno()]})
    return {"startupinfo": startup}


def taken_over(number: int) -> Connection:
    """The pipe of a number, in the process that got it."""
    kind: type[Connection] = getattr(connection, "PipeConnection", Connection)
    return kind(number)


def interpreter() -> tuple[str, Mapping[str, str]]:
    """The program of this Python and the environment that it needs.

    On Windows the program of a virtual environment starts another one, to which it hands over no
    pipe and which has another number.
    """
    base = getattr(sys, "_base_executable", sys.executable)
    if sys.platform == "win32" and base != sys.executable:
        return base, {"__PYVENV_LAUNCHER__": sys.executable}
    return sys.executable, {}
