"""Rows of a part that another kind of machine measured: their times do not compare."""

from __future__ import annotations

from pathlib import Path

import polars as pl

import aerocues
from aerocues.results.hashing import content_hash
from aerocues.results.store import Store
from aerocues.results.versions import machine_name


def rows_of_others(folder: Path) -> frozenset[str]:
    """Keys of the rows of a results folder that were not measured on a machine like this one."""
    rows = aerocues.Results(folder).table()
    return frozenset(rows.filter(_of_others())["row_key"])


def remove_rows_of_others(folder: Path) -> int:
    """Remove these rows from a results folder, so that they are measured here; how many."""
    store = Store.open(folder)
    with store.writing():
        keys, files, rows = rows_of_others(folder), store.parts(), store.rows()
        own = rows.filter(~_of_others())
        if len(own) < len(rows):
            store.leave_out(keys)
            name = content_hash(sorted(own["row_key"]))
            store.write_rows(name, own.to_dicts())
            for file in files:
                if file.stem != name:  # these rows alone may have been kept before
                    file.unlink()
    return len(keys)


def _of_others() -> pl.Expr:
    return pl.col("machine") != machine_name()
