"""Measured results: the rows of a folder, and the progress of a run."""

from __future__ import annotations

import shutil
import weakref
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from aerocues.notebooks import as_html
from aerocues.phrases import count
from aerocues.results.combination_columns import METHODS
from aerocues.results.failures import failures_of
from aerocues.results.plan_table import TIMED_ALONE
from aerocues.results.statuses import RETRIED
from aerocues.results.store import Store
from aerocues.results.study_place import place_of_results
from aerocues.results.timing import DISTURBED

if TYPE_CHECKING:
    import polars as pl

    from aerocues.results.clouds import Cloud
    from aerocues.results.integrity import Checked


def timing_counts(table: pl.DataFrame) -> tuple[dict[str, int], int]:
    """Number of rows by source of their times, and of rows with a stage that shared its core."""
    timings = dict(sorted(table["timing"].drop_nulls().value_counts().iter_rows()))
    return timings, int((table["wall_over_cpu"] > DISTURBED).sum())


@dataclass(frozen=True)
class RunStatus:
    """Progress of a run.

    ``statuses`` counts rows by status; ``failures`` counts failed rows by status, detector and
    descriptor, with an example message. ``timings`` counts rows by the source of their times;
    ``disturbed`` counts rows with a stage that never had a core to itself. ``untimed`` counts
    finished rows whose exclusive timing is still missing.
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
        The folder, a file made by `pack`, or ``study:NAME`` for a part of the study.

    Raises
    ------
    StoreError
        If `folder` is neither a results folder nor packed results.
    """

    def __init__(self, folder: str | Path) -> None:
        self._path = place = place_of_results(folder)
        self._given = folder
        if place.is_file():
            from aerocues.results.packing import unpack

            place = unpack(place)
            weakref.finalize(self, shutil.rmtree, place, ignore_errors=True)
        self._store = Store.open(place)

    def __repr__(self) -> str:
        table = self.table()
        if table.is_empty():
            return f"Results {self._path}: no rows yet"
        counts = table["status"].value_counts(sort=True).iter_rows()
        statuses = ", ".join(f"{status} {number:,}" for status, number in counts)
        datasets = ", ".join(table["dataset"].unique().sort())
        combinations = table.select(METHODS).n_unique()
        pairs = table.select("dataset", "pair").n_unique()
        models = len(self.reconstructions())
        made = f"; {count(models, 'reconstruction')}" if models else ""
        return (
            f"Results {self._path}: {count(combinations, 'combination')} on "
            f"{count(pairs, 'pair')} of {datasets}, {count(len(table), 'row')}: {statuses}{made}"
        )

    def _repr_html_(self) -> str:
        from aerocues.results.medians import combination_medians

        table = self.table()
        return as_html(repr(self), table if table.is_empty() else combination_medians(table))

    @property
    def folder(self) -> Path:
        """The opened folder or packed file."""
        return self._path

    @property
    def given(self) -> str | Path:
        """What was opened: the folder or file, or ``study:NAME``."""
        return self._given

    @property
    def settings(self) -> dict[str, Any]:
        """Configuration, versions and machine of the latest run."""
        return self._store.run()

    def table(self) -> pl.DataFrame:
        """One row per pair and combination, in a fixed order; columns as in `schema.COLUMNS`."""
        return self._store.table()

    def reconstructions(self) -> pl.DataFrame:
        """One row per dataset and combination, see `reconstruction_schema.RECONSTRUCTIONS`."""
        return self._store.reconstructions()

    def cloud(self, row_key: str) -> Cloud | None:
        """The cloud of the reconstruction with this row key; None if it has no cloud."""
        return self._store.cloud(row_key)

    def pack(self, file: str | Path) -> Path:
        """Write the content of the folder into one file, which `Results` can open elsewhere.

        Unzipped, it is a results folder again, which `aerocues.run` can continue.

        Parameters
        ----------
        file : path
            Zip file to write. An existing file is replaced atomically.

        Raises
        ------
        StoreError
            If the folder cannot be read or the file cannot be written.
        """
        from aerocues.results.export import write_file
        from aerocues.results.packing import packed

        write_file(Path(file), packed(self._store))
        return Path(file)

    def sql(self, query: str) -> pl.DataFrame:
        """Answer an SQL query over the tables ``results`` and ``reconstructions``.

        Raises
        ------
        StoreError
            If the query is not a read-only query, or fails.
        """
        from aerocues.results.queries import answer

        return answer(query, {"results": self.table(), "reconstructions": self.reconstructions()})

    def verify(self) -> list[Checked]:
        """Every file of the folder, with what is wrong with it.

        Raises
        ------
        StoreError
            If a file may not be read.
        """
        return self._store.check()

    def status(self) -> RunStatus:
        """Numbers of finished, remaining and failed rows, failures by reason."""
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
