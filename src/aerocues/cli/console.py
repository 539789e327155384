"""Where output goes and how wide it is."""

from __future__ import annotations

import os
import sys
from typing import TYPE_CHECKING

from aerocues.cli.wording import in_options

if TYPE_CHECKING:
    from collections.abc import Iterator

    import polars as pl
    from rich.console import Console
    from rich.table import Table

    from aerocues.datasets.dataset import Dataset

WIDTH_OF_FILES = 100


def standard_output() -> Console:
    """A console on standard output; 100 columns wide where that is no terminal."""
    from rich.console import Console

    known = sys.stdout.isatty() or "COLUMNS" in os.environ
    return Console(width=None if known else WIDTH_OF_FILES, highlight=False, soft_wrap=False)


def tell_images(dataset: Dataset) -> None:
    """What was left out of a folder, and what looks odd, on standard error."""
    for note in dataset.notes:
        sys.stderr.write(f"{in_options(note)}\n")


def plain_table(*headings: str, numbers: int = 0, gap: int = 2) -> Table:
    """A table without lines; the last `numbers` columns are set to the right."""
    from rich.table import Table

    table = Table(box=None, pad_edge=False, padding=(0, gap, 0, 0), header_style="bold")
    table.show_header = any(headings)
    for position, heading in enumerate(headings):
        is_number = position >= len(headings) - numbers
        table.add_column(heading, justify="right" if is_number else "left", no_wrap=is_number)
    return table


def print_table(console: Console, table: Table) -> None:
    """Print a table without the blanks at the ends of its lines."""
    with console.capture() as capture:
        console.print(table)
    for line in capture.get().splitlines():
        console.out(line.rstrip(), highlight=False)


def aligned(table: pl.DataFrame) -> Iterator[str]:
    """Lines of a table with every row and column, unabridged, however wide that is."""
    columns = []
    for column in table.iter_columns():
        texts = [column.name, *(_text(value) for value in column)]
        width = max(map(len, texts))
        pad = str.rjust if column.dtype.is_numeric() else str.ljust
        columns.append([pad(text, width) for text in texts])
    for cells in zip(*columns, strict=True):
        yield "  ".join(cells).rstrip()


def _text(value: object) -> str:
    if value is None:
        return ""
    return f"{value:.6g}" if isinstance(value, float) else " ".join(str(value).split())
