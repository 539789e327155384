"""A results folder: Parquet parts, one a finished unit, and run.json."""

from __future__ import annotations

import contextlib
import io
import json
import os
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from aerocues.errors import StoreError
from aerocues.evaluation.metrics import Row
from aerocues.evaluation.schema import polars_schema
from aerocues.evaluation.statuses import STATUSES

if TYPE_CHECKING:
    import polars as pl

PARTS = "parts"
RUN = "run.json"
RETRIED = tuple(status.name for status in STATUSES if status.retried)


class Store:
    """Results in a folder. A part is written beside and renamed: there is never half a file."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._parts = folder / PARTS

    @classmethod
    def create(cls, folder: Path) -> Store:
        """Open a results folder for writing, made where it is missing.

        Raises
        ------
        StoreError
            If the folder cannot be made or written, or is something else.
        """
        if folder.exists() and not folder.is_dir():
            raise StoreError(f"{folder} is a file; give -o the name of a folder")
        if folder.is_dir() and not (folder / RUN).exists() and any(folder.iterdir()):
            left_over = [path for path in folder.iterdir() if path.name != PARTS]
            if left_over:
                raise StoreError(
                    f"{folder} holds other files ({left_over[0].name}, ...); give -o a new or "
                    "empty folder"
                )
        store = cls(folder)
        try:
            store._parts.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryFile(dir=store._parts):
                pass
        except OSError as error:
            raise StoreError(
                f"cannot write to {folder}: {error.strerror}; choose another folder with -o"
            ) from error
        store._remove_leftovers()
        return store

    @classmethod
    def open(cls, folder: Path) -> Store:
        """Open an existing results folder for reading; StoreError where there is none."""
        if not (folder / RUN).is_file():
            raise StoreError(
                f"{folder} is no results folder (it has no {RUN}); make one with "
                f"'aerocues run DATASET -o {folder}'"
            )
        return cls(folder)

    def _remove_leftovers(self) -> None:
        for path in [*self._parts.glob("*.tmp"), *self.folder.glob("*.tmp")]:
            path.unlink(missing_ok=True)

    def write_rows(self, name: str, rows: Sequence[Row]) -> None:
        """Store the rows of a finished unit, all or none.

        Raises
        ------
        StoreError
            If the disk is full or the folder cannot be written any more.
        """
        import polars as pl

        table = pl.DataFrame(rows, schema=polars_schema(), orient="row")
        # Not to the disk at once: polars has errors of its own for a disk that is full.
        content = io.BytesIO()
        table.write_parquet(content, compression="zstd")
        self._write(self._parts / f"{name}.parquet", content.getvalue())

    def write_run(self, facts: Mapping[str, Any]) -> None:
        """Store the configuration, the versions and the machine of the latest run."""
        text = json.dumps(facts, indent=2, sort_keys=True, default=str) + "\n"
        self._write(self.folder / RUN, text.encode())

    def _write(self, target: Path, content: bytes) -> None:
        beside = target.with_name(f"{target.name}.{os.getpid()}.tmp")
        try:
            with beside.open("wb") as file:
                file.write(content)
                file.flush()
                os.fsync(file.fileno())
            beside.replace(target)
        except OSError as error:
            with contextlib.suppress(OSError):
                beside.unlink(missing_ok=True)
            reason = error.strerror or str(error)
            raise StoreError(
                f"cannot write {target}: {reason}; what was finished is kept: make room or access "
                "and run the same command again"
            ) from error

    def run(self) -> dict[str, Any]:
        """What `write_run` stored last."""
        try:
            content = json.loads((self.folder / RUN).read_text(encoding="utf-8"))
        except (OSError, json.JSONDecodeError) as error:
            raise StoreError(
                f"cannot read {self.folder / RUN}: {error}; run the same 'aerocues run' command "
                "again to restore it"
            ) from error
        if not isinstance(content, dict):
            raise StoreError(f"{self.folder / RUN} is damaged; run the same command again")
        return content

    def parts(self) -> list[Path]:
        """The finished parts, the oldest first."""
        return sorted(
            self._parts.glob("*.parquet"), key=lambda path: (path.stat().st_mtime_ns, path.name)
        )

    def present(self, timing: str, *, retry_failed: bool) -> frozenset[str]:
        """Keys of the rows that need not be measured again.

        Rows with shared times do not serve where exclusive ones are asked for; the converse does.
        """
        parts = self.parts()
        if not parts:
            return frozenset()
        import polars as pl

        rows = self._scan(parts).select("row_key", "status", "timing")
        if timing == "exclusive":
            rows = rows.filter(pl.col("timing") == "exclusive")
        if retry_failed:
            rows = rows.filter(~pl.col("status").is_in(RETRIED))
        return frozenset(self._collect(rows)["row_key"].to_list())

    def table(self) -> pl.DataFrame:
        """The rows that belong to the settings of the latest run, each once, in order.

        Where a row was measured again, the later one counts; exclusive times come before shared.
        """
        import polars as pl

        parts = self.parts()
        schema = polars_schema()
        if not parts:
            return pl.DataFrame(schema=schema)
        identity = ["dataset", "pair", "image_1", "image_2"]
        methods = ["detector", "descriptor", "norm", "matcher"]
        rows = (
            self._scan(parts)
            .with_row_index("written")
            .filter(pl.col("settings_key") == self.run().get("settings_key"))
            .sort(pl.col("timing") == "exclusive", "written")
            .unique([*identity, *methods], keep="last")
            .sort(*identity, *methods)
            .select(list(schema))
        )
        return self._collect(rows)

    def _scan(self, parts: list[Path]) -> pl.LazyFrame:
        import polars as pl

        # Older results lack the columns that have come since.
        return pl.scan_parquet(
            parts,
            schema=pl.Schema(polars_schema()),
            missing_columns="insert",
            extra_columns="ignore",
        )

    def _collect(self, rows: pl.LazyFrame) -> pl.DataFrame:
        import polars as pl

        try:
            return rows.collect()
        except (pl.exceptions.PolarsError, OSError) as error:
            raise StoreError(
                f"cannot read the results in {self.folder}: {' '.join(str(error).split())[:200]}; "
                "remove the damaged part and run the same command again"
            ) from error
