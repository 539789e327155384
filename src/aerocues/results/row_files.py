"""The measured rows of a results folder, one file per finished part.

The rows of a unit are stored in their own file, so that finished work is never lost. Reading tens
of thousands of small files takes a minute, so those of a long run are merged.
"""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from aerocues.errors import StoreError
from aerocues.results.folder_files import FolderFiles, own_files
from aerocues.results.hashing import content_hash
from aerocues.results.integrity import Checked, check_tables, warn_of
from aerocues.results.schema import polars_schema
from aerocues.results.whole_files import parquet_content

if TYPE_CHECKING:
    import polars as pl

TOGETHER = "together-"
MANY_FILES = 1000


class RowFiles(FolderFiles):
    """The files with rows in one folder."""

    def __init__(self, folder: Path) -> None:
        super().__init__(folder)
        self._sound: set[tuple[Path, int, int]] = set()

    def files(self) -> list[Path]:
        """All files, sorted by name."""
        return own_files(self.folder, ".parquet")

    def write(self, name: str, rows: pl.DataFrame) -> None:
        """Store rows in a file, all or none.

        Raises
        ------
        StoreError
            If the disk is full or the folder is not writable any more.
        """
        self._write(self.folder / f"{name}.parquet", parquet_content(rows))

    def read(self, columns: Sequence[str] | None = None) -> pl.DataFrame:
        """All rows as they were written, including duplicates; damaged files are told and left out.

        Parameters
        ----------
        columns : sequence of str, optional
            Only these columns.

        Raises
        ------
        StoreError
            If a file may not be read.
        """
        files = self.files()
        damaged = self.damaged(files)
        try:
            rows = self._read(_without(files, damaged), columns)
        except StoreError:
            if self.files() != files:
                return self.read(columns)  # another process merged some files in the meantime
            damaged = self.damaged(files, decode=True)
            rows = self._read(_without(files, damaged), columns)
        warn_of(damaged, "its rows are left out; `aerocues.run` measures them again")
        return rows

    def damaged(self, files: Sequence[Path], *, decode: bool = False) -> list[Checked]:
        """Which files are damaged; `decode` also looks into those without a checksum.

        Raises
        ------
        StoreError
            If a file may not be read.
        """
        states = {file: (file, state.st_size, state.st_mtime_ns) for file, state in _states(files)}
        unknown = [file for file in states if decode or states[file] not in self._sound]
        checked = check_tables(unknown, polars_schema(), decode=decode)
        self._sound.update(states[each.file] for each in checked if each.problem is None)
        return [each for each in checked if each.problem is not None]

    def put_together(self) -> None:
        """Merge very many small files into a few large ones; at any time all rows are on the disk.

        Raises
        ------
        StoreError
            If the disk is full or a file is damaged.
        """
        small = [file for file in self.files() if not file.name.startswith(TOGETHER)]
        for start in range(0, len(small) - MANY_FILES + 1, MANY_FILES):
            files = small[start : start + MANY_FILES]
            rows = self._read(files, None)
            self.write(f"{TOGETHER}{content_hash([file.name for file in files])}", rows)
            for file in files:
                # Where a reader keeps a file, as on Windows, its rows are there twice: no harm.
                with contextlib.suppress(PermissionError):
                    file.unlink(missing_ok=True)

    def _read(self, files: Sequence[Path], columns: Sequence[str] | None) -> pl.DataFrame:
        import polars as pl

        schema = pl.Schema(polars_schema())
        if not files:
            return pl.DataFrame(schema=schema).select(columns or list(schema))
        # Older results lack columns that were added later.
        rows = pl.scan_parquet(
            list(files), schema=schema, missing_columns="insert", extra_columns="ignore"
        )
        return self._collect(rows.select(columns or list(schema)))


def _states(files: Sequence[Path]) -> Iterator[tuple[Path, os.stat_result]]:
    """The files that are still there."""
    for file in files:
        with contextlib.suppress(FileNotFoundError):
            yield file, file.stat()


def _without(files: Sequence[Path], damaged: Sequence[Checked]) -> list[Path]:
    left_out = {checked.file for checked in damaged}
    return [file for file in files if file not in left_out]
