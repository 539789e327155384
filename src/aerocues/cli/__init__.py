"""The command line: one thin file a command."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NoReturn


def main(arguments: Sequence[str] | None = None) -> NoReturn:
    """Run the command line and exit: 0 done, 2 a mistake of input, 130 or 143 interrupted.

    1 is for a reconstruction of which no model succeeded, and a run in which every row is an error.

    Parameters
    ----------
    arguments : sequence of str, optional
        What stands after ``aerocues``; by default what this process was started with.
    """
    import os
    import sys

    from aerocues.cli.memory_limit import LEAST, WATCHED, Watched, limit_of_memory, too_small

    words = sys.argv[1:] if arguments is None else arguments
    limit = limit_of_memory()
    if limit is not None and limit < LEAST:
        sys.stderr.write(f"error: {too_small(limit)}\n")
        sys.exit(2)
    if limit is not None and WATCHED not in os.environ:
        sys.exit(Watched(words, limit).exit_code())
    from aerocues.cli.program import exit_code

    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):  # names of files need not be Unicode
            stream.reconfigure(errors="backslashreplace")
    sys.exit(exit_code(words))
