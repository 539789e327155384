"""Programs that start in a copy of a process which has imported what they need.

A guide has more than a hundred short commands: half of what each takes is importing the same
modules anew.
"""

from __future__ import annotations

import importlib
import json
import os
import runpy
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import IO, NoReturn, Self

IMPORTED = (
    "cv2",
    "polars",
    "pycolmap",
    "rich.progress",
    "rich.table",
    "scipy.stats",
    "typer._adapters",
    "aerocues.cli.console",
    "aerocues.cli.program",
    "aerocues.evaluation.run",
    "aerocues.modelling.recommend",
    "aerocues.report.page",
    "aerocues.report.pictures",
    "aerocues.report.report",
    "aerocues.tuning.recommend",
)
"""Of these, nothing has started a thread after its import, which a copy would lack."""


class Preloaded:
    """A process that copies itself for each program; a context manager that ends it."""

    def __enter__(self) -> Self:
        repository = Path(__file__).parents[1]
        self._process = subprocess.Popen(
            [sys.executable, __file__],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            cwd=repository,
        )
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self._process.communicate()

    def run(
        self, words: Sequence[str], folder: Path, environment: Mapping[str, str]
    ) -> subprocess.CompletedProcess[str]:
        """Run `aerocues ...` or `python FILE` in a folder, and wait for it."""
        with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as error:
            asked = {
                "words": list(words),
                "folder": str(folder),
                "environment": dict(environment),
                "streams": [f"/proc/{os.getpid()}/fd/{file.fileno()}" for file in (out, error)],
            }
            code = int(self._ask(json.dumps(asked)))
            return subprocess.CompletedProcess(words, code, _content(out), _content(error))

    def _ask(self, line: str) -> str:
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        print(line, file=self._process.stdin, flush=True)
        return self._process.stdout.readline()


def _content(file: IO[str]) -> str:
    file.seek(0)
    return file.read()


def _serve() -> None:
    for module in IMPORTED:
        importlib.import_module(module)
    for line in sys.stdin:
        process = os.fork()
        if process == 0:
            _become(**json.loads(line))
        code = os.waitstatus_to_exitcode(os.waitpid(process, 0)[1])
        sys.stdout.write(f"{code}\n")
        sys.stdout.flush()


def _become(
    words: list[str], folder: str, environment: dict[str, str], streams: list[str]
) -> NoReturn:
    """Be the program that was asked for."""
    for number, name in enumerate((os.devnull, *streams)):
        os.dup2(os.open(name, os.O_RDWR), number)
    os.chdir(folder)
    os.environ.clear()
    os.environ.update(environment)
    sys.path[:0] = filter(None, environment.get("PYTHONPATH", "").split(os.pathsep))
    sys.argv = words[1:] if words[0] == "python" else words
    if words[0] == "python":
        sys.path.insert(0, folder)
        runpy.run_path(words[1], run_name="__main__")
        sys.exit()
    from aerocues.cli import main

    main()


if __name__ == "__main__":
    _serve()
