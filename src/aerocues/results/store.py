"""A results folder: parts with the measured rows, the plan of all rows, and run.json."""

from __future__ import annotations

import contextlib
import tempfile
from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from aerocues.errors import StoreError
from aerocues.results.best_rows import best_rows
from aerocues.results.folder_lock import LOCK, folder_lock
from aerocues.results.hashing import content_hash
from aerocues.results.integrity import Checked, check_tables, warn_of
from aerocues.results.metrics import Row
from aerocues.results.plan_table import merge_plans, plan_of, with_all_columns
from aerocues.results.reconstruction_store import CLOUDS, RECONSTRUCTED, ReconstructionStore
from aerocues.results.row_files import RowFiles
from aerocues.results.run_record import read_record, record_content
from aerocues.results.schema import polars_schema
from aerocues.results.statuses import RETRIED
from aerocues.results.timing import TIMINGS, Timing
from aerocues.results.whole_files import parquet_content

if TYPE_CHECKING:
    import polars as pl


PARTS = "parts"
RUN = "run.json"
RACE = "race.json"
PLAN = "plan.parquet"
REFERENCES = "references"
"""Where workers share references of pairs; it may be deleted, and is not packed."""
SURVEYS = "surveys"
"""What a quick look at the images of flights found; it may be deleted, and is not packed."""
DAMAGED = "damaged"
"""Where damaged files are put, for whoever wants to look at them."""
OWN = (PARTS, RUN, RACE, PLAN, RECONSTRUCTED, CLOUDS, REFERENCES, SURVEYS, DAMAGED, LOCK)
LONGEST_LIST = 12


def others_in(folder: Path) -> list[str]:
    """Names of what does not belong to a results folder; what systems hide there is no matter."""
    names = (path.name for path in folder.iterdir())
    return sorted(name for name in names if name not in OWN and not name.startswith("."))


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
        from aerocues.results.study_place import refuse_part

        refuse_part(folder)
        if folder.exists() and not folder.is_dir():
            raise StoreError(f"{folder} is a file; give the name of a folder as `output`")
        if folder.is_dir() and not (folder / RUN).exists() and any(folder.iterdir()):
            others = others_in(folder)
            if others:
                raise StoreError(
                    f"{folder} holds other files ({others[0]}, ...); give a new or "
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

    @property
    def surveys(self) -> Path:
        """The folder of surveys; it need not exist."""
        return self.folder / SURVEYS

    @contextlib.contextmanager
    def writing(self) -> Iterator[None]:
        """Lock the folder against other runs, remove partial files, and put damaged ones aside.

        Raises
        ------
        StoreError
            If another process is writing to the folder, or a file may not be read.
        """
        with folder_lock(self.folder):
            self._remove_leftovers()
            self._set_aside_damaged()
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
        beside = (self._parts, self.folder, self.folder / CLOUDS, self.references, self.surveys)
        for path in [path for folder in beside for path in folder.glob("*.tmp")]:
            path.unlink(missing_ok=True)

    def _set_aside_damaged(self) -> None:
        damaged = self._row_files.damaged(self.parts(), decode=True)
        damaged += [each for each in self._check_tables() if each.problem]
        if not damaged:
            return
        aside = self.folder / DAMAGED
        try:
            aside.mkdir(exist_ok=True)
            for checked in damaged:
                checked.file.replace(aside / checked.file.name)
        except OSError as error:
            raise StoreError(
                f"{damaged[0]}, and it cannot be moved to {aside}: {error.strerror}; grant access "
                "and run the same command again"
            ) from error
        warn_of(damaged, f"it was moved to {aside}; what it held is measured again where asked for")

    def _check_tables(self) -> list[Checked]:
        """The tables of which there is one each, checked."""
        tables = [self.folder / name for name in (PLAN, RECONSTRUCTED)]
        return check_tables([file for file in tables if file.is_file()], decode=True)

    def check(self) -> list[Checked]:
        """Every file of the folder, checked.

        Raises
        ------
        StoreError
            If a file may not be read.
        """
        tables = check_tables(self.parts(), polars_schema(), decode=True)
        return [self._check_run(), *self._check_tables(), *tables, *self.check_clouds()]

    def _check_run(self) -> Checked:
        file = self.folder / RUN
        try:
            record = read_record(file)
        except StoreError as error:
            return Checked(file, str(error))
        return Checked(file, record.problem, has_checksum=record.has_checksum)

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
        self._write(self.folder / RUN, record_content(facts))

    def write_plan(self, rows: pl.DataFrame) -> None:
        """Add the planned rows of a run; see `planned_rows.merge_plans`."""
        new = with_all_columns(rows)
        old = self.plan() if (self.folder / PLAN).is_file() else new.clear()
        self._write(self.folder / PLAN, parquet_content(merge_plans(old, new)))

    def leave_out(self, row_keys: Collection[str]) -> None:
        """Take rows out of the plan; what was measured stays in the folder, and counts no more."""
        import polars as pl

        kept = self.plan().filter(~pl.col("row_key").is_in(list(row_keys)))
        self._write(self.folder / PLAN, parquet_content(kept))

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
        """The planned rows under the settings of the latest run.

        Where the plan is damaged, the measured rows under these settings stand for it.
        """
        import polars as pl

        plan = self.folder / PLAN
        damaged = [each for each in check_tables([plan], decode=True) if each.problem]
        warn_of(damaged, "every measured row counts as planned; `aerocues.run` restores the plan")
        rows = plan_of(self.rows()) if damaged else self.plan()
        return rows.filter(pl.col("settings_key") == self.run().get("settings_key"))

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
        """The latest record of `write_run`.

        Raises
        ------
        StoreError
            If it cannot be read, or is not of the form that it must have.
        """
        record = read_record(self.folder / RUN)
        if record.problem:
            warn_of([Checked(self.folder / RUN, record.problem)], "its values are used as they are")
        return record.facts

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
