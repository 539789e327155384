"""The measured rows of a results folder, in as many files as they were finished in.

A unit's rows are a file of their own, so that nothing finished is lost. Tens of thousands of small
files take a minute to read, so that those of a long run are put together.
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
    """Files with rows in one folder."""

    def files(self) -> list[Path]:
        """All of them, by name."""
        return sorted(self.folder.glob("*.parquet"))

    def write(self, name: str, rows: pl.DataFrame) -> None:
        """Store rows in a file, all or none.

        Raises
        ------
        StoreError
            If the disk is full or the folder cannot be written any more.
        """
        self._write(self.folder / f"{name}.parquet", parquet_content(rows))

    def read(self, columns: Sequence[str] | None = None) -> pl.DataFrame:
        """All rows as they were written, also those that were written twice.

        Parameters
        ----------
        columns : sequence of str, optional
            Only these.

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
            return self.read(columns)  # another process put some together meanwhile

    def put_together(self) -> None:
        """Make few large files of very many small ones; the rows are on the disk all the time.

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
        # Older results lack the columns that have come since.
        rows = pl.scan_parquet(
            files, schema=schema, missing_columns="insert", extra_columns="ignore"
        )
        return self._collect(rows.select(columns or list(schema)))
