"""What a notebook shows of an object: a sentence and the first rows of a table."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import polars as pl

ROWS = 10


def as_html(sentence: str, table: pl.DataFrame) -> str:
    """A sentence above the first rows of a table, figures with three decimals."""
    import polars as pl
    from polars import selectors

    told = f"<p>{escape(sentence)}</p>"
    if table.is_empty():
        return told
    more = f"<p>{len(table) - ROWS:,} more rows</p>" if len(table) > ROWS else ""
    with pl.Config(tbl_hide_dataframe_shape=True, fmt_str_lengths=60, tbl_cols=-1, tbl_rows=ROWS):
        rounded = table.head(ROWS).with_columns(selectors.float().round(3))
        return f"{told}{rounded._repr_html_()}{more}"
