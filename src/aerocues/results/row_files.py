"""The measured rows of a results folder, one file per finished part.

The rows of a unit are stored in their own file, so that finished work is never lost. Reading tens
of thousands of small files takes a minute, so those of a long run are merged.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from aerocues.errors import StoreError
from aerocues.results.folder_files import FolderFiles
from aerocues.results.hashing import content_hash
from aerocues.results.schema import polars_schema
from aerocues.results.whole_files import parquet_content

if TYPE_CHECKING:
    import polars as pl

TOGETHER = "together-"
MANY_FILES = 1000


class RowFiles(FolderFiles):
    """The files with rows in one folder."""

    def files(self) -> list[Path]:
        """All files, sorted by name."""
        return sorted(self.folder.glob("*.parquet"))

    def write(self, name: str, rows: pl.DataFrame) -> None:
        """Store rows in a file, all or none.

        Raises
        ------
        StoreError
            If the disk is full or the folder is not writable any more.
        """
        self._write(self.folder / f"{name}.parquet", parquet_content(rows))

    def read(self, columns: Sequence[str] | None = None) -> pl.DataFrame:
        """All rows as they were written, including duplicates.

        Parameters
        ----------
        columns : sequence of str, optional
            Only these columns.

        Raises
        ------
        StoreError
            If a file is damaged.
        """
        files = self.files()
        try:
            return self._read(files, columns)
        except StoreError:
            if self.files() == files:
                raise
            return self.read(columns)  # another process merged some files in the meantime

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
                file.unlink(missing_ok=True)

    def _read(self, files: list[Path], columns: Sequence[str] | None) -> pl.DataFrame:
        import polars as pl

        schema = pl.Schema(polars_schema())
        if not files:
            return pl.DataFrame(schema=schema).select(columns or list(schema))
        # Older results lack columns that were added later.
        rows = pl.scan_parquet(
            files, schema=schema, missing_columns="insert", extra_columns="ignore"
        )
        return self._collect(rows.select(columns or list(schema)))
