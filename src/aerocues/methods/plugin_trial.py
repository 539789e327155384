"""Imports plug-ins in processes of their own, with a time limit, and remembers what they said."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import asdict
from importlib.machinery import PathFinder
from importlib.metadata import EntryPoint
from pathlib import Path
from typing import IO, Any, get_args

from aerocues.methods.declarations import Declaration
from aerocues.methods.descriptors import DescriptorType
from aerocues.scratch_folders import cache_folder, scratch_prefix

SECONDS = 30.0
"""That an import may take; packages of neural networks take up to 10."""
LAST_WORDS = 120
PRINTS = "it prints to standard output when it is imported ({words}), which programs read"
FORM = 3
"""Number of the form of a remembered declaration."""


def tried_declaration(entry: EntryPoint, group: str) -> Declaration:
    """What a plug-in says about itself, or why it cannot be used.

    It is imported again only after its files, or the packages that are installed, have changed.
    """
    place = cache_folder("plug-ins") / f"{_digest([entry.value, group, sys.prefix])}.json"
    key = _digest([FORM, sys.version, entry.value, group, list(_states(entry))])
    found = _remembered(place, key)
    if found is None:
        found = _imported(entry, group)
        _remember(place, key, found)
    return found


def _imported(entry: EntryPoint, group: str) -> Declaration:
    """Import a plug-in in a new process, and end everything that it has started there."""
    with tempfile.TemporaryDirectory(prefix=scratch_prefix("plug-in")) as name:
        answer, printed, errors = (Path(name) / part for part in ("answer", "out", "err"))
        with printed.open("wb") as out, errors.open("wb") as err:
            code = _exit_code([entry.value, group, str(answer)], out, err)
        if code is None:
            return Declaration(problem=f"its import did not end within {SECONDS:g} seconds")
        if words := _last_words(printed):
            return Declaration(problem=PRINTS.format(words=repr(words)))
        if code or not answer.exists():
            told = f"its import ended the process ({_how(code)}) {_last_words(errors)}"
            return Declaration(problem=told.strip())
        return _declaration(json.loads(answer.read_text(encoding="utf-8")))


def _exit_code(arguments: list[str], out: IO[bytes], err: IO[bytes]) -> int | None:
    """How the process ended in which a plug-in was imported; None if it did not by itself."""
    # Whatever this process can import; "" stands for where it is now.
    paths = os.pathsep.join(path or str(Path.cwd()) for path in sys.path)
    process = subprocess.Popen(
        [sys.executable, "-m", "aerocues.methods.plugin_child", *arguments],
        stdin=subprocess.DEVNULL,
        stdout=out,
        stderr=err,
        start_new_session=True,
        env={**os.environ, "PYTHONPATH": paths},
    )
    try:
        return process.wait(SECONDS)
    except subprocess.TimeoutExpired:
        return None
    finally:
        _end(process)


def _end(process: subprocess.Popen[bytes]) -> None:
    """End a process, and those that it has started."""
    if hasattr(os, "killpg"):
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(process.pid, signal.SIGKILL)
    process.kill()
    process.wait()


def _how(code: int) -> str:
    if code >= 0:
        return f"exit code {code}"
    with contextlib.suppress(ValueError):
        return signal.Signals(-code).name
    return f"signal {-code}"


def _last_words(file: Path) -> str:
    """The end of what was printed, in one line."""
    return " ".join(file.read_bytes()[-1000:].decode(errors="replace").split())[-LAST_WORDS:]


def _declaration(stored: dict[str, Any]) -> Declaration:
    """A declaration from JSON."""
    dtypes = {norm: tuple(known) for norm, known in stored.pop("dtypes").items()}
    if stored["dtype"] not in get_args(DescriptorType):
        raise ValueError(f"no type {stored['dtype']}")
    taken = tuple(stored.pop("takes_descriptors"))
    return Declaration(**stored, dtypes=dtypes, takes_descriptors=taken)


def _states(entry: EntryPoint) -> Iterator[object]:
    """What decides how an import ends: the plug-in's files, and what is installed."""
    if entry.dist is not None:
        yield [entry.dist.name, entry.dist.version]
    for path in map(Path, sys.path):
        if path.name in ("site-packages", "dist-packages") and path.is_dir():
            yield [str(path), path.stat().st_mtime_ns]
    try:
        spec = PathFinder.find_spec(entry.module.partition(".")[0])
    except (AttributeError, ImportError, ValueError):
        return  # no module has such a name, which is told when it is imported
    places = list(spec.submodule_search_locations or ()) if spec else []
    files = [Path(spec.origin)] if spec and spec.origin else []
    for file in (*files, *(file for place in places for file in sorted(Path(place).rglob("*.py")))):
        with contextlib.suppress(OSError):
            state = file.stat()
            yield [str(file), state.st_size, state.st_mtime_ns]


def _digest(content: object) -> str:
    return hashlib.sha256(json.dumps(content).encode()).hexdigest()[:32]


def _remembered(place: Path, key: str) -> Declaration | None:
    """What was remembered under a key; None where there is nothing, or it cannot be read."""
    try:
        stored = json.loads(place.read_text(encoding="utf-8"))
        return _declaration(stored["declared"]) if stored["key"] == key else None
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
        return None


def _remember(place: Path, key: str, declared: Declaration) -> None:
    """Remember a declaration; where there is no room, it is asked for again next time."""
    beside = place.with_name(f"{place.name}.{os.getpid()}.tmp")
    with contextlib.suppress(OSError):
        place.parent.mkdir(parents=True, exist_ok=True)
        beside.write_text(json.dumps({"key": key, "declared": asdict(declared)}), encoding="utf-8")
        beside.replace(place)
