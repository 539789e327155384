"""Messages of the library in the words of the command line."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

import aerocues
from aerocues.cli.program import exit_code
from aerocues.cli.wording import in_options

SOURCES = Path(aerocues.__file__).parent
OPTION = re.compile(r"(?<![\w-])--[a-z]")
COMMAND = re.compile(r"\b(aerocues|pip|dask)\b")


@pytest.mark.parametrize(
    ("message", "told"),
    [
        ("`max_keypoints` must be 0", "--max-keypoints must be 0"),
        ('use `pairs="exhaustive"`', "use --pairs exhaustive"),
        ('use `pairs="two words"`', "use --pairs 'two words'"),
        ("give `max_width=160` or less", "give --max-width 160 or less"),
        ("run `aerocues.run` first", "run 'aerocues run' first"),
        ("read it with `aerocues.import_results`", "read it with 'aerocues import'"),
        ("`a b` is not a name", "`a b` is not a name"),
    ],
)
def test_names_become_options(message: str, told: str) -> None:
    assert in_options(message) == told


@pytest.mark.parametrize(
    ("words", "told"),
    [
        # `everything` is called --all, `results` --from.
        (["run", "synthetic", "-o", "r", "--combinations", "ORB-ORB-L2-*"], "--all runs it"),
        (
            ["reconstruct", "synthetic", "-o", "m", "--top", "2", "--combinations", "A"],
            "among --from;",
        ),
        (["run", "synthetic", "-o", "r", "--pairs", "gps"], "leave --pairs out"),
        (["score", "nowhere"], "make one with 'aerocues run'"),
    ],
)
def test_each_command_prints_its_own_options(
    words: list[str],
    told: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert exit_code(words) == 2
    printed = capsys.readouterr().err
    assert told in printed
    assert "`" not in printed


def texts(file: Path) -> Iterator[str]:
    """Texts in the code of a file that are not docstrings."""
    tree = ast.parse(file.read_text(encoding="utf-8"))
    told = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    for node in ast.walk(tree):
        if isinstance(node, ast.JoinedStr):
            told |= {id(part) for part in node.values}
            parts = (part.value for part in node.values if isinstance(part, ast.Constant))
            yield "".join(map(str, parts))
        elif (
            isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in told
        ):
            yield node.value


@pytest.mark.slow
def test_the_library_speaks_of_parameters_only() -> None:
    """Exports write commands of other tools."""
    elsewhere = {"cli", "exports"}
    files = [file for file in SOURCES.rglob("*.py") if not elsewhere & set(file.parts)]
    assert len(files) > 200
    found = [
        (file.name, text)
        for file in files
        for text in texts(file)
        if OPTION.search(text) and not COMMAND.search(text)
    ]
    assert found == []
