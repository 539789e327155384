"""The program as a whole: help, version, mistakes, pipes."""

from __future__ import annotations

import re
import subprocess
import sys

import pytest

import aerocues
from tests.cli.conftest import Call

COMMANDS = ("run", "status", "results", "import", "methods", "datasets")


def test_help_lists_the_commands_and_is_the_default(call: Call) -> None:
    answer = call("--help")
    assert answer.code == 0
    assert [command for command in COMMANDS if f"\n  {command} " not in answer.out] == []
    assert call() == answer


@pytest.mark.parametrize("command", [*COMMANDS, "methods why", "methods list"])
def test_each_command_has_help(call: Call, command: str) -> None:
    answer = call(*command.split(), "--help")
    assert answer.code == 0
    assert answer.out.startswith(f"Usage: aerocues {command}")


def test_version(call: Call) -> None:
    assert call("--version").out == f"aerocues {aerocues.__version__}\n"


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["nothing"], "'aerocues --help'"),
        (["run", "photos"], "'aerocues run --help'"),
        (["status"], "'aerocues status --help'"),
        (["methods", "--nothing"], "'aerocues methods --help'"),
    ],
)
def test_wrong_usage_is_told_in_one_line(call: Call, words: list[str], told: str) -> None:
    answer = call(*words)
    assert answer.code == 2
    assert answer.out == ""
    assert answer.err.startswith("error: ")
    assert answer.err.count("\n") == 1
    assert told in answer.err


def test_an_unforeseen_error_of_the_system_is_told_in_one_line(
    call: Call, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail() -> None:
        raise PermissionError(13, "Permission denied", "some/file")

    monkeypatch.setattr("aerocues.methods.plugins.installed_methods", fail)
    answer = call("methods")
    assert answer.code == 2
    assert answer.err.startswith("error: some/file: Permission denied; ")


def test_an_interrupted_command_says_so(call: Call, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupt() -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("aerocues.methods.plugins.installed_methods", interrupt)
    answer = call("methods")
    assert (answer.code, answer.err) == (130, "interrupted\n")


@pytest.mark.parametrize("command", ["methods list --all", "methods", "methods --json"])
def test_a_reader_that_has_seen_enough_is_no_error(command: str) -> None:
    program = f"{sys.executable} -m aerocues {command} | head -n 1"
    piped = subprocess.run(["bash", "-c", program], capture_output=True, text=True, check=False)
    assert piped.stderr == ""
    assert piped.stdout.count("\n") == 1


def test_help_loads_nothing_heavy() -> None:
    code = (
        "import sys\nfrom aerocues.cli import main\n"
        "try:\n    main(['--help'])\nexcept SystemExit:\n    print(*sys.modules, file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    heavy = {"cv2", "numpy", "polars", "pyarrow", "psutil", "PIL", "rich.live", "numba"}
    assert set(done.stderr.split()) & heavy == set()


def test_help_is_in_plain_words(call: Call) -> None:
    from aerocues.simulation.scenes import SCENES

    listed = call("--help").out.split("Commands:")[1]
    assert "..." not in listed
    assert [kind.name for kind in SCENES if kind.name not in call("simulate", "--help").out] == []
    for command in ("run", "reconstruct", "simulate", "airsim collect", "datasets fetch"):
        assert not re.search(r"--\S+ <(str|int|float)\b", call(*command.split(), "--help").out)
