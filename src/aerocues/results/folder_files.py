"""Files in a results folder: written atomically, read with errors that say what to do."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from aerocues.errors import StoreError
from aerocues.results.integrity import reason_of, without_words_of_libraries
from aerocues.results.whole_files import write_whole

if TYPE_CHECKING:
    import polars as pl


def own_files(folder: Path, ending: str) -> list[Path]:
    """The files with an ending in a folder, sorted by name; hidden ones are others' (``._x``)."""
    return sorted(
        file
        for file in folder.glob(f"*{ending}")
        if not file.name.startswith(".") and file.is_file()
    )


class FolderFiles:
    """A folder whose files are written under another name and then renamed."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def _write(self, target: Path, content: bytes) -> None:
        try:
            write_whole({target: content})
        except OSError as error:
            reason = error.strerror or str(error)
            raise StoreError(
                f"cannot write {target}: {reason}; finished work is kept: free space or grant "
                "access "
                "and run the same command again"
            ) from error

    def _collect(self, rows: pl.LazyFrame) -> pl.DataFrame:
        import polars as pl

        try:
            with without_words_of_libraries():
                return rows.collect()
        except (pl.exceptions.PolarsError, pl.exceptions.PanicException, OSError) as error:
            raise StoreError(
                f"cannot read the results in {self.folder}: {reason_of(error)}; run the same "
                "command again"
            ) from error
