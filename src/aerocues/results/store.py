"""A results folder: parts with the measured rows, the plan of all rows, and run.json."""

from __future__ import annotations

import contextlib
import json
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from aerocues.errors import StoreError
from aerocues.results.best_rows import best_rows
from aerocues.results.folder_lock import LOCK, folder_lock
from aerocues.results.hashing import content_hash
from aerocues.results.metrics import Row
from aerocues.results.plan_table import merge_plans, with_all_columns
from aerocues.results.reconstruction_store import CLOUDS, RECONSTRUCTED, ReconstructionStore
from aerocues.results.row_files import RowFiles
from aerocues.results.schema import polars_schema
from aerocues.results.statuses import RETRIED
from aerocues.results.timing import TIMINGS, Timing
from aerocues.results.whole_files import json_content, parquet_content

if TYPE_CHECKING:
    import polars as pl


PARTS = "parts"
RUN = "run.json"
RACE = "race.json"
PLAN = "plan.parquet"
REFERENCES = "references"
"""Where workers share references of pairs; it may be deleted, and is not packed."""
OWN = (PARTS, RUN, RACE, PLAN, RECONSTRUCTED, CLOUDS, REFERENCES, LOCK)
LONGEST_LIST = 12


class Store(ReconstructionStore):
    """Results in a folder. Parts are written under another name and renamed: no partial files."""

    def __init__(self, folder: Path) -> None:
        super().__init__(folder)
        self._parts = folder / PARTS
        self._row_files = RowFiles(self._parts)

    @classmethod
    def create(cls, folder: Path) -> Store:
        """Open a results folder for writing; it is created if it does not exist.

        Raises
        ------
        StoreError
            If the folder cannot be created or written, or has other content.
        """
        if folder.exists() and not folder.is_dir():
            raise StoreError(f"{folder} is a file; give the name of a folder as `output`")
        if folder.is_dir() and not (folder / RUN).exists() and any(folder.iterdir()):
            left_over = [path for path in folder.iterdir() if path.name not in OWN]
            if left_over:
                raise StoreError(
                    f"{folder} holds other files ({left_over[0].name}, ...); give a new or "
                    "empty folder as `output`"
                )
        store = cls(folder)
        try:
            store._parts.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryFile(dir=store._parts):
                pass
        except OSError as error:
            raise StoreError(
                f"cannot write to {folder}: {error.strerror}; choose another `output`"
            ) from error
        return store

    @property
    def references(self) -> Path:
        """The folder of references, absolute; it need not exist."""
        return (self.folder / REFERENCES).absolute()

    @contextlib.contextmanager
    def writing(self) -> Iterator[None]:
        """Lock the folder against other runs, and remove partial files of an interrupted run.

        Raises
        ------
        StoreError
            If another process is writing to the folder.
        """
        with folder_lock(self.folder):
            self._remove_leftovers()
            self._row_files.put_together()
            yield
            self._row_files.put_together()

    @classmethod
    def open(cls, folder: Path) -> Store:
        """Open an existing results folder for reading; StoreError if it is not one."""
        if not (folder / RUN).is_file():
            inner = sorted(run.parent.name for run in folder.glob(f"*/{RUN}"))
            if inner:
                more = f" and {len(inner) - LONGEST_LIST} more" if inner[LONGEST_LIST:] else ""
                raise StoreError(
                    f"{folder} is a folder of results folders; give one of them, such as "
                    f"{folder / inner[0]}: {', '.join(inner[:LONGEST_LIST])}{more}"
                )
            raise StoreError(
                f"{folder} is not a results folder (it has no {RUN}); make one with `aerocues.run`"
            )
        return cls(folder)

    def _remove_leftovers(self) -> None:
        beside = (self._parts, self.folder, self.folder / CLOUDS, self.references)
        for path in [path for folder in beside for path in folder.glob("*.tmp")]:
            path.unlink(missing_ok=True)

    def write_rows(self, name: str, rows: Sequence[Row]) -> None:
        """Store the rows of a finished part of a unit, all or none.

        Raises
        ------
        StoreError
            If the disk is full or the folder is not writable any more.
        """
        import polars as pl

        table = pl.DataFrame(rows, schema=polars_schema(), orient="row")
        self._row_files.write(name, table)

    def write_finished(self, detector: str, rows: Sequence[Row]) -> None:
        """Store the finished rows of one detector; see `write_rows`.

        The same measurements with other timings are stored as another part.
        """
        content = [[row["row_key"], row["timing"]] for row in rows]
        self.write_rows(f"{detector}-{content_hash(content)}", rows)

    def write_run(self, facts: Mapping[str, Any]) -> None:
        """Store configuration, versions and machine of the latest run."""
        self._write(self.folder / RUN, json_content(facts))

    def write_plan(self, rows: pl.DataFrame) -> None:
        """Add the planned rows of a run; see `planned_rows.merge_plans`."""
        new = with_all_columns(rows)
        old = self.plan() if (self.folder / PLAN).is_file() else new.clear()
        self._write(self.folder / PLAN, parquet_content(merge_plans(old, new)))

    def plan(self) -> pl.DataFrame:
        """All planned rows, under all settings."""
        import polars as pl

        if not (self.folder / PLAN).is_file():
            raise StoreError(
                f"{self.folder / PLAN} is missing; measure the same again with `aerocues.run` to "
                "restore it"
            )
        return with_all_columns(self._collect(pl.scan_parquet(self.folder / PLAN)))

    def planned(self) -> pl.DataFrame:
        """The planned rows under the settings of the latest run."""
        import polars as pl

        return self.plan().filter(pl.col("settings_key") == self.run().get("settings_key"))

    def planned_keys(self) -> frozenset[str]:
        """Keys of the planned rows; empty if there is no plan."""
        try:
            return frozenset(self.planned()["row_key"].to_list())
        except StoreError:
            return frozenset()  # a new folder, or a file that the next run restores

    def measured(self, keys: frozenset[str]) -> frozenset[str]:
        """The measured rows among these."""
        return keys & frozenset(self._row_files.read(("row_key",))["row_key"]) if keys else keys

    def run(self) -> dict[str, Any]:
        """The latest record of `write_run`."""
        try:
            content = json.loads((self.folder / RUN).read_text(encoding="utf-8"))
        except (OSError, json.JSONDecodeError) as error:
            raise StoreError(
                f"cannot read {self.folder / RUN}: {error}; measure the same again with "
                "`aerocues.run` to restore it"
            ) from error
        if not isinstance(content, dict):
            raise StoreError(
                f"{self.folder / RUN} is damaged; measure the same again with `aerocues.run`"
            )
        return content

    def parts(self) -> list[Path]:
        """The files with finished rows."""
        return self._row_files.files()

    def present(self, timing: Timing, *, retry_failed: bool) -> frozenset[str]:
        """Keys of the rows that need not be measured again.

        A row with a worse timing does not replace one with a better timing, unless it failed; the
        reverse is possible.
        """
        import polars as pl

        rows = self._row_files.read(("row_key", "status", "timing"))
        good_enough = TIMINGS[TIMINGS.index(timing) :]
        failed = pl.col("status").is_in(RETRIED)
        rows = rows.filter(failed | pl.col("timing").is_in(good_enough))
        if retry_failed:
            rows = rows.filter(~failed)
        return frozenset(rows["row_key"].to_list())

    def table(self) -> pl.DataFrame:
        """The measured rows of the plan, each once and in order; see `best_rows`."""
        rows = self.rows()
        return best_rows(self.planned(), rows) if len(rows) else rows

    def rows(self) -> pl.DataFrame:
        """All stored rows as they were written, planned or not, including duplicates."""
        return self._row_files.read()
