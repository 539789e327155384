"""SQL queries over tables, with readable errors."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from itertools import chain
from typing import TYPE_CHECKING

from aerocues.errors import StoreError

if TYPE_CHECKING:
    import polars as pl

# Other statements change tables, which are copies here: they would have no effect, silently.
READING = ("SELECT", "WITH")
# Spaces, brackets and comments may precede the first word.
FIRST_WORD = re.compile(r"(?:\s|\(|--[^\n]*(?:\n|$)|/\*.*?\*/)*(\w*)", re.DOTALL)
# Names in quotes, and what is no word of the query: texts and comments.
QUOTED = re.compile(r"""("(?:[^"]|"")*")|'(?:[^']|'')*'|--[^\n]*|/\*.*?\*/""", re.DOTALL)
# Functions of polars that stand for a table, as a query writes them and as a plan shows them.
READS_FILES = re.compile(r'\b(?:read|scan)_\w+"?\s*\(', re.IGNORECASE)
SCAN = re.compile(r"^\s*\w+ SCAN ", re.MULTILINE)
NO_COLUMN = re.compile(r"""(?:unable to find column|no column named) ["'](.+?)["']""")
LONGEST_REASON = 160


def answer(
    query: str,
    tables: Mapping[str, pl.DataFrame],
    listing: str = "aerocues results RESULTS --columns",
) -> pl.DataFrame:
    """Answer a read-only query.

    Parameters
    ----------
    query : str
        SQL in the dialect of polars.
    tables : mapping of str to pl.DataFrame
    listing : str
        The command that lists the columns, which errors name.

    Raises
    ------
    StoreError
        If the query is not a read-only query, or fails.
    """
    import polars as pl

    word = FIRST_WORD.match(query)
    if word is None or word[1].upper() not in READING:
        raise StoreError(
            "a query must begin with SELECT or WITH, such as 'SELECT detector, inliers FROM "
            "results'; "
            "other statements are not supported"
        )
    no_files = StoreError(
        f"a query sees the tables {' and '.join(tables)} only, no files; leave out functions such "
        "as read_csv"
    )
    if READS_FILES.search(QUOTED.sub(lambda found: found[1] or " ", query)):
        raise no_files
    try:
        answer = pl.SQLContext(tables).execute(query)
        if SCAN.search(answer.explain(optimized=False)):
            raise no_files
        return answer.collect()
    except (pl.exceptions.PolarsError, pl.exceptions.PanicException) as error:
        columns = {name: table.columns for name, table in tables.items()}
        raise StoreError(_reason(str(error), columns, listing)) from error


def _reason(message: str, tables: Mapping[str, Sequence[str]], listing: str) -> str:
    """The first line of the message of polars; the rest shows how it parsed the query."""
    first = message.partition("\n")[0]
    if unknown := NO_COLUMN.search(first):
        return f"{_no_column(unknown[1], tables)}'{listing}' lists all"
    cut = first if len(first) <= LONGEST_REASON else f"{first[:LONGEST_REASON]}..."
    return (
        f"the query failed: {cut}; the tables are {' and '.join(tables)}, and names such as "
        '"gt_precision@3" need double quotes'
    )


def _no_column(name: str, tables: Mapping[str, Sequence[str]]) -> str:
    """That there is no such column, and where it or a similar one is."""
    if elsewhere := [table for table, columns in tables.items() if name in columns]:
        return f"the column {name} is in {' and '.join(elsewhere)}, not in the table asked; "
    close = get_close_matches(name, list(dict.fromkeys(chain(*tables.values()))), n=3)
    hint = f"did you mean {' or '.join(close)}? " if close else ""
    return f"the column {name} does not exist; {hint}"
