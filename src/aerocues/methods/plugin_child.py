"""The process in which a plug-in is imported for the first time: what it does there harms nobody.

    python -m aerocues.methods.plugin_child ENTRY GROUP ANSWER

What the plug-in says about itself goes to the file ANSWER, as JSON.
"""

from __future__ import annotations

import json
import os
import sys
from dataclasses import asdict
from importlib.metadata import EntryPoint
from pathlib import Path

from aerocues.methods.declarations import Declaration, read_declaration

FORKS = "it starts a copy of its process (fork) when it is imported"
CLOSES = "it closes standard output when it is imported"


def main() -> None:
    """Import, write the answer and end at once, whatever threads the plug-in has started."""
    value, group, answer = sys.argv[1:]
    copies: list[bool] = []
    if hasattr(os, "register_at_fork"):
        os.register_at_fork(before=lambda: copies.append(True), after_in_child=_end_copy)
    declared = read_declaration(EntryPoint(name="", value=value, group=""), group)
    if copies:
        declared = Declaration(problem=FORKS)
    elif _is_closed():
        declared = Declaration(problem=CLOSES)
    whole = Path(f"{answer}.whole")
    whole.write_text(json.dumps(asdict(declared)), encoding="utf-8")
    whole.replace(answer)
    os._exit(0)


def _end_copy() -> None:
    """End a copy of this process before it does the rest of the import a second time."""
    os._exit(0)


def _is_closed() -> bool:
    """Whether standard output is gone; flushes it otherwise."""
    try:
        sys.stdout.flush()
        os.fstat(1)
    except (OSError, ValueError, AttributeError):
        return True
    return False


if __name__ == "__main__":
    main()
