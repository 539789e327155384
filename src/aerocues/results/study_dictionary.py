"""The data dictionary of a study: its tables and their columns."""

from __future__ import annotations

from dataclasses import replace

from aerocues.results.cpu_times import CPU, OF_WALL_TIMES
from aerocues.results.reconstruction_schema import RECONSTRUCTIONS
from aerocues.results.schema import COLUMNS, TIMES, Column
from aerocues.results.study import PARTS

WALL = {column.name for column in TIMES if not column.name.endswith(CPU)}


def dictionary() -> dict[str, tuple[Column, ...]]:
    """The columns of each table of a study, by the name of the table."""
    part = PARTS[0]
    return {
        "parts": PARTS,
        "results": (part, *map(_in_a_study, COLUMNS)),
        "reconstructions": (part, *RECONSTRUCTIONS),
    }


def _in_a_study(column: Column) -> Column:
    """A column of results as it is in a study, where times are CPU times."""
    if column.name in WALL:
        return replace(column, definition=f"the same as {column.name}{CPU}")
    if column.name in OF_WALL_TIMES:
        return replace(column, definition="null: it describes wall times")
    return column
