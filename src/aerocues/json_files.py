"""JSON files that users write or carry about, and in plain words why one cannot be read."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

from aerocues.errors import AerocuesError
from aerocues.text_files import decoded


def read_json(path: Path, what: str, kind: type[AerocuesError], next_step: str) -> Any:
    """The content of a file, without doubled keys and numbers that are not finite.

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
        return json.loads(
            decoded(path.read_bytes()),
            object_pairs_hook=_object,
            parse_constant=_finite,
            parse_float=_finite,
        )
    except (OSError, ValueError, RecursionError) as error:
        raise kind(f"cannot read {what} {path}: {why_unreadable(error)}; {next_step}") from error


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """An object; of two values under one key nobody knows which one is meant."""
    found: dict[str, Any] = {}
    for key, value in pairs:
        if key in found:
            raise ValueError(f"it has the key {json.dumps(key)} twice")
        found[key] = value
    return found


def _finite(text: str) -> float:
    """A number; JSON knows neither infinity nor NaN, but Python reads both."""
    value = float(text)
    if not math.isfinite(value):
        raise ValueError(f"{text} is not a finite number")
    return value


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
