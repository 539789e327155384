"""JSON files that users write or carry about, and in plain words why one cannot be read."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from aerocues.errors import AerocuesError


def read_json(path: Path, what: str, kind: type[AerocuesError], next_step: str) -> Any:
    """The content of a file.

    Parameters
    ----------
    path : path
    what : str
        What the file is to hold, such as ``the grid``.
    kind : type of AerocuesError
        What is raised.
    next_step : str
        What to do where it cannot be read.
    """
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise kind(f"cannot read {what} {path}: {why_unreadable(error)}; {next_step}") from error


def why_unreadable(error: OSError | ValueError | RecursionError) -> str:
    """Why a file of a user cannot be read as JSON, in words that follow a colon."""
    if isinstance(error, RecursionError):
        return "it is nested too deeply"
    if isinstance(error, FileNotFoundError):
        return "there is no such file"
    if isinstance(error, IsADirectoryError):
        return "it is a folder"
    if isinstance(error, OSError):
        return error.strerror or str(error)
    if isinstance(error, json.JSONDecodeError):
        return f"it is not written as JSON (line {error.lineno}, column {error.colno})"
    if isinstance(error, UnicodeDecodeError):
        return "it is not text in UTF-8"
    return str(error)
