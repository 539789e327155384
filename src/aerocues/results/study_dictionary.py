"""The data dictionary of a study: its tables and their columns."""

from __future__ import annotations

from aerocues.results.reconstruction_schema import RECONSTRUCTIONS
from aerocues.results.schema import COLUMNS, Column
from aerocues.results.study import PARTS


def dictionary() -> dict[str, tuple[Column, ...]]:
    """The columns of each table of a study, by the name of the table."""
    part = PARTS[0]
    return {
        "parts": PARTS,
        "results": (part, *COLUMNS),
        "reconstructions": (part, *RECONSTRUCTIONS),
    }
