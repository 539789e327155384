"""The page about the thesis: its commands run, and every figure of ours in it is printed."""

from __future__ import annotations

import contextlib
import io
import os
import re
import shlex
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from aerocues.cli import main
from tests.test_documentation import REPOSITORY, blocks

PAGE = REPOSITORY / "docs" / "thesis.md"
SECTION = re.compile(r"^## ", re.MULTILINE)
HERE, THESIS = " here", " thesis"
# Sections whose figures the commands of the section before print.
FED_BY = {"Stability": "Best combinations over all datasets", "Components": "Stability"}


COMPARED = (
    "First ten of each dataset",
    "Best combinations over all datasets",
    "Stability",
    "Components",
    "Sensitivity",
    "Platforms",
)


@dataclass(frozen=True)
class Table:
    """A table of the page: its heading and rows of cells."""

    heading: list[str]
    rows: list[list[str]]

    def columns(self, ending: str) -> dict[str, list[str]]:
        """Columns whose heading is a name and the ending, by name."""
        return {
            name.removesuffix(ending.strip()).strip(): [row[position] for row in self.rows]
            for position, name in enumerate(self.heading)
            if f" {name}".endswith(ending)
        }


def sections() -> dict[str, str]:
    """The text of each section by its title."""
    parts = SECTION.split(PAGE.read_text(encoding="utf-8"))
    return {"": parts[0], **{part.split("\n", 1)[0]: part for part in parts[1:]}}


def tables_of(text: str) -> Iterator[Table]:
    for found in re.findall(r"(?:^\|.*\|\n)+", text, re.MULTILINE):
        lines = [
            [cell.strip() for cell in line.strip("|").split("|")] for line in found.split("\n")
        ]
        yield Table(lines[0], [line for line in lines[2:] if len(line) == len(lines[0])])


def printed(command: str) -> str:
    """What a command prints, in this process."""
    output = io.TextIOWrapper(io.BytesIO(), encoding="utf-8")
    with contextlib.redirect_stdout(output), pytest.raises(SystemExit) as ending:
        main(shlex.split(command)[1:])
    assert ending.value.code == 0, command
    output.flush()
    raw = output.buffer
    assert isinstance(raw, io.BytesIO)
    return raw.getvalue().decode()


@pytest.fixture(scope="module")
def outputs(shared_data: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """What the commands of each section print, run from top to bottom."""
    folder = tmp_path_factory.mktemp("thesis")
    for file in (shared_data / "published").iterdir():
        (folder / file.name).symlink_to(file)
    before = Path.cwd()
    os.chdir(folder)
    wide = pytest.MonkeyPatch()
    wide.setenv("COLUMNS", "200")  # else columns are left out where the terminal is narrow
    try:
        found: dict[str, str] = {}
        by_title = {title: text.splitlines(keepends=True) for title, text in sections().items()}
        every = {command for block in blocks(PAGE) for command, _ in block.commands()}
        for title, lines in by_title.items():
            own = [line[2:].strip() for line in lines if line.startswith("$ ")]
            every -= set(own)
            told = "".join(printed(command) for command in own)
            found[title] = told or found.get(FED_BY.get(title, ""), "")
    finally:
        wide.undo()
        os.chdir(before)
    assert not every
    return found


@pytest.mark.slow
@pytest.mark.parametrize("title", COMPARED)
def test_every_figure_of_ours_is_printed(outputs: dict[str, str], title: str) -> None:
    text = outputs[title]
    lines = [set(re.findall(r"[^\s|;]+", line)) for line in text.splitlines()]
    for table in tables_of(sections()[title]):
        ours = list(table.columns(HERE).values())
        for number, row in enumerate(table.rows):
            wanted = {column[number] for column in ours}
            if row[0].startswith("`"):
                named = {row[0].strip("`"), *wanted}
                assert any(named <= line for line in lines), row
            else:
                assert all(value in text for value in wanted), row


@pytest.mark.parametrize(
    "title", [title for title in sections() if "Largest diff" in sections()[title]]
)
def test_the_largest_differences_are_told(title: str) -> None:
    text = sections()[title]
    told = re.findall(r"^Largest differences: (.*)\.$", text, re.MULTILINE)
    tables = [table for table in tables_of(text) if table.columns(HERE)]
    assert len(told) == len(tables)
    for sentence, table in zip(told, tables, strict=True):
        theirs = table.columns(THESIS)
        expected = []
        for name, ours in table.columns(HERE).items():
            pairs = zip(ours, theirs[name], strict=True)
            largest = max(abs(float(one) - float(other)) for one, other in pairs)
            digits = len(ours[0].partition(".")[2])
            expected.append(f"{name} {largest:.{digits}f}")
        assert sentence == ", ".join(expected)
