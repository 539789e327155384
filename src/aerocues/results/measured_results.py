"""Measured results: the rows of a folder, and how far a run has got."""

from __future__ import annotations

import shutil
import weakref
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from aerocues.results.failures import failures_of
from aerocues.results.plan_table import TIMED_ALONE
from aerocues.results.statuses import RETRIED
from aerocues.results.store import Store
from aerocues.results.timing import DISTURBED

if TYPE_CHECKING:
    import polars as pl

    from aerocues.results.clouds import Cloud


def timing_counts(table: pl.DataFrame) -> tuple[dict[str, int], int]:
    """Rows by where their times come from, and those of which a stage had to share its core."""
    timings = dict(sorted(table["timing"].drop_nulls().value_counts().iter_rows()))
    return timings, int((table["wall_over_cpu"] > DISTURBED).sum())


@dataclass(frozen=True)
class RunStatus:
    """How far a run has got.

    ``statuses`` counts rows by status; ``failures`` counts the rows that ended otherwise than ok,
    by status, detector and descriptor, with an example message. ``timings`` counts rows by where
    their times come from, and ``disturbed`` those of which a stage never had a core to itself.
    ``untimed`` counts those that are done, but are still to be timed by themselves.
    """

    planned: int
    done: int
    statuses: Mapping[str, int]
    failures: pl.DataFrame
    exclusions: list[dict[str, Any]]
    timings: Mapping[str, int]
    disturbed: int
    untimed: int

    @property
    def left(self) -> int:
        return max(self.planned - self.done, 0)


def as_results(results: Results | str | Path) -> Results:
    """Results as they are, or those of a folder or packed file."""
    return results if isinstance(results, Results) else Results(results)


class Results:
    """The rows of a results folder.

    Parameters
    ----------
    folder : path
        The folder, or the file that `pack` made of it.

    Raises
    ------
    StoreError
        If `folder` is no results folder and no packed one.
    """

    def __init__(self, folder: str | Path) -> None:
        self._path = place = Path(folder)
        if place.is_file():
            from aerocues.results.packing import unpack

            place = unpack(place)
            weakref.finalize(self, shutil.rmtree, place, ignore_errors=True)
        self._store = Store.open(place)

    @property
    def folder(self) -> Path:
        """The folder, or the packed file, that was opened."""
        return self._path

    @property
    def settings(self) -> dict[str, Any]:
        """Configuration, versions and machine of the latest run."""
        return self._store.run()

    def table(self) -> pl.DataFrame:
        """One row a pair and combination, in a fixed order; columns as in `schema.COLUMNS`."""
        return self._store.table()

    def reconstructions(self) -> pl.DataFrame:
        """One row a dataset and combination, see `reconstruction_schema.RECONSTRUCTIONS`."""
        return self._store.reconstructions()

    def cloud(self, row_key: str) -> Cloud | None:
        """The cloud of the reconstruction whose row has this key; None where there is none."""
        return self._store.cloud(row_key)

    def pack(self, file: str | Path) -> Path:
        """Write everything that the folder holds into one file, for `Results` to open elsewhere.

        Unzipped, it is a results folder again, which `aerocues.run` continues.

        Parameters
        ----------
        file : path
            A zip file; one that is there is replaced, whole or not at all.

        Raises
        ------
        StoreError
            If the folder cannot be read or the file not be written.
        """
        from aerocues.results.export import write_file
        from aerocues.results.packing import packed

        write_file(Path(file), packed(self._store))
        return Path(file)

    def sql(self, query: str) -> pl.DataFrame:
        """Answer a SQL query over the tables ``results`` and ``reconstructions``.

        Raises
        ------
        StoreError
            If the query does something else than to read, or cannot be understood.
        """
        from aerocues.results.queries import answer

        return answer(query, {"results": self.table(), "reconstructions": self.reconstructions()})

    def status(self) -> RunStatus:
        """How many rows are done, left and failed, by reason."""
        import polars as pl

        table = self.table()
        counts = table.group_by("status").len().sort("len", "status", descending=[True, False])
        timings, disturbed = timing_counts(table)
        settings, planned = self.settings, self._store.planned()
        rough = table.filter(~pl.col("status").is_in(RETRIED), pl.col("timing") != "exclusive")
        to_time = planned.filter(TIMED_ALONE).join(rough, on="row_key", how="semi")
        return RunStatus(
            planned=len(planned),
            done=len(table),
            statuses=dict(zip(counts["status"], counts["len"], strict=True)),
            failures=failures_of(table),
            exclusions=list(settings.get("exclusions", [])),
            timings=timings,
            disturbed=disturbed,
            untimed=len(to_time),
        )
