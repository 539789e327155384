"""Messages of the library in the words of the command line: options in place of parameters."""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterable
from typing import Any

QUOTED = re.compile(r"`(?:aerocues\.(?P<verb>\w+)|(?P<name>\w+)(?:=(?P<value>[^`]*))?)`")
COMMANDS = {"import_results": "import", "write_report": "report"}
"""Commands that are called differently from the function."""


def in_options(message: str, parameters: Iterable[Any] = ()) -> str:
    """A message with options and commands in place of parameters and functions in backticks.

    Parameters
    ----------
    message : str
    parameters : iterable of click parameters
        Of the command that was called, then of all others; a name that none of them has becomes
        the option of that name.
    """
    by_name: dict[str, Any] = {}
    for parameter in parameters:
        by_name.setdefault(parameter.name, parameter)

    def replaced(found: re.Match[str]) -> str:
        if verb := found["verb"]:
            return f"'aerocues {COMMANDS.get(verb, verb)}'"
        return _option(found["name"], found["value"], by_name.get(found["name"]))

    return QUOTED.sub(replaced, message)


def _option(name: str, value: str | None, parameter: Any) -> str:
    """``--pairs exhaustive``; an argument of the command, as ``DATASET``, has no name."""
    option = f"--{name.replace('_', '-')}"
    if parameter is not None:
        dashed = [word for word in parameter.opts if word.startswith("--")]
        option = dashed[0] if dashed else parameter.metavar or name.upper()
        if value == "False" and parameter.secondary_opts:
            option = parameter.secondary_opts[0]
    if value is None or value in ("True", "False"):
        return option
    return f"{option} {shlex.quote(value.strip(chr(34)))}"
