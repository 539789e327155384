"""What Windows and macOS lack is hidden here: nothing depends on modules of POSIX alone."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest

from aerocues.results import whole_files
from aerocues.results.measured_results import Results
from aerocues.results.whole_files import put_in_place
from tests.cli.conftest import write_views

HIDDEN_MODULES = ("fcntl", "resource", "pwd", "grp", "termios", "tty", "pty", "posix", "syslog")
# Python imports it when it starts, in every process: it takes from aerocues what others have not.
HIDES = f"""
import builtins, os, signal, sys

HIDDEN = {HIDDEN_MODULES!r}
original = builtins.__import__


def without_posix(name, globals=None, *rest, **more):
    asks = (globals or {{}}).get("__name__", "")
    if name in HIDDEN and asks.partition(".")[0] == "aerocues":
        raise ImportError(f"{{name}} is hidden from {{asks}}")
    return original(name, globals, *rest, **more)


builtins.__import__ = without_posix
for name in ("sched_getaffinity", "sched_setaffinity", "killpg", "setsid", "getpgid", "mkfifo"):
    if hasattr(os, name):
        delattr(os, name)
for name in ("SIGHUP", "SIGALRM", "alarm", "SIGUSR1"):
    if hasattr(signal, name):
        delattr(signal, name)
"""


@pytest.mark.slow
def test_a_measurement_needs_nothing_of_posix_alone(tmp_path: Path) -> None:
    (tmp_path / "hooks").mkdir()
    (tmp_path / "hooks" / "sitecustomize.py").write_text(HIDES)
    write_views(tmp_path / "photos")
    path = os.pathsep.join((str(tmp_path / "hooks"), os.environ.get("PYTHONPATH", "")))
    for words in (
        ("run", "photos", "-o", "out", "--combinations", "ORB-ORB-HAM-BF", "--timing-pairs", "1"),
        ("status", "out", "--verify"),
        ("results", "out", "--csv", "rows.csv"),
        ("methods", "why", "ORB-ORB-HAM-BF"),
    ):
        done = subprocess.run(
            [sys.executable, "-m", "aerocues", *words],
            env={**os.environ, "PYTHONPATH": path, "PYTHONUTF8": "0", "LC_ALL": "C"},
            cwd=tmp_path,
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr
    assert Results(tmp_path / "out").table()["status"].to_list() == ["ok"] * 3


def test_no_module_of_posix_is_imported_when_a_module_is(repository: Path) -> None:
    found = []
    for file in sorted((repository / "src").rglob("*.py")):
        tree = ast.parse(file.read_text(encoding="utf-8"))
        for statement in tree.body:
            names = [alias.name for alias in getattr(statement, "names", [])]
            names.append(getattr(statement, "module", None) or "")
            if isinstance(statement, ast.Import | ast.ImportFrom) and {*HIDDEN_MODULES} & {*names}:
                found.append(str(file))
    assert found == []


def test_texts_are_read_and_written_in_a_stated_encoding(repository: Path) -> None:
    """Windows would take another one than UTF-8."""
    found = []
    for file in sorted((repository / "src").rglob("*.py")):
        for call in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if not isinstance(call, ast.Call) or not isinstance(call.func, ast.Attribute):
                continue
            stated = {keyword.arg for keyword in call.keywords} & {"encoding", "errors"}
            is_text = call.func.attr == "write_text" or (
                call.func.attr == "read_text" and not call.args
            )
            if is_text and not stated:
                found.append(f"{file.name}:{call.lineno}")
    # Files of Linux, which are ASCII, and a model of COLMAP.
    assert [
        place for place in found if not place.startswith(("clock.py", "versions.py", "exports.py"))
    ] == []


def test_a_file_is_replaced_as_soon_as_its_reader_lets_go(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(whole_files, "ON_WINDOWS", True)
    monkeypatch.setattr(whole_files, "PAUSES", (0.0, 0.0, 0.0))
    replace, tries = Path.replace, []

    def open_elsewhere(beside: Path, target: Path) -> Path:
        tries.append(beside)
        if len(tries) < 3:
            raise PermissionError(13, "Access is denied", str(target))
        return replace(beside, target)

    monkeypatch.setattr(Path, "replace", open_elsewhere)
    (tmp_path / "new").write_text("new")
    put_in_place(tmp_path / "new", tmp_path / "old")
    assert ((tmp_path / "old").read_text(), len(tries)) == ("new", 3)
    tries.clear()
    monkeypatch.setattr(whole_files, "PAUSES", ())
    (tmp_path / "new").write_text("newer")
    with pytest.raises(PermissionError):
        put_in_place(tmp_path / "new", tmp_path / "old")
