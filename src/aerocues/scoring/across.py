"""Compares results folders across datasets and across machines."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from aerocues.errors import ScoreError
from aerocues.notebooks import as_html
from aerocues.phrases import count
from aerocues.scoring.combinations import has_chance_test, suitable_preset
from aerocues.scoring.comparison import Comparison, Over, compare
from aerocues.scoring.cues import Scores, score
from aerocues.scoring.measured import Measured, MeasuredRows, settings_from, table_of
from aerocues.scoring.platforms import compare_times, device_factors
from aerocues.scoring.settings import Names

if TYPE_CHECKING:
    import polars as pl


UNKNOWN_MACHINE = "unknown machine"


class Stored(Measured, Protocol):
    """Results in a folder."""

    @property
    def folder(self) -> Path:
        """The folder, or the packed file."""
        ...


@dataclass(frozen=True)
class Entry:
    """One dataset, measured by one machine.

    Attributes
    ----------
    name : str
        The dataset; with the machine or the folder if the dataset alone is ambiguous.
    dataset, machine : str
    rows : pl.DataFrame
    scores : Scores
    preset : str
    reconstructed : bool
        Whether it has reconstructions.
    source : int
        Index of the results that it comes from.
    """

    name: str
    dataset: str
    machine: str
    rows: pl.DataFrame
    scores: Scores
    preset: str
    reconstructed: bool = False
    source: int = 0


@dataclass(frozen=True)
class Machines:
    """The same dataset on two machines.

    Attributes
    ----------
    first, second : Entry
    rankings : Comparison
        The two rankings.
    times : pl.DataFrame or str
        See `platforms.compare_times`; a text says why they cannot be compared.
    """

    first: Entry
    second: Entry
    rankings: Comparison
    times: pl.DataFrame | str

    def ranks(self) -> pl.DataFrame:
        """Scores and ranks side by side, sorted by the rank on the first machine.

        Returns
        -------
        pl.DataFrame
            ``combination, first_rank, first_score, second_rank, second_score``.
        """
        import polars as pl

        ranks = self.rankings.ranks()
        columns = {"combination": self.rankings.alternatives}
        for side, rank, score_ in zip(
            ("first", "second"), ranks, self.rankings.scores, strict=True
        ):
            columns |= {f"{side}_rank": rank, f"{side}_score": score_}
        return (
            pl.DataFrame(columns, nan_to_null=True)
            .with_columns(pl.col("first_rank", "second_rank").cast(pl.Int64))
            .sort("first_rank", "second_rank", "combination", nulls_last=True)
        )


@dataclass(frozen=True)
class ComparedResults:
    """Rankings side by side, and the same data on two machines.

    Attributes
    ----------
    entries : sequence of Entry
        What was scored: each dataset as each machine measured it.
    rankings : Comparison
        Of all entries.
    machines : sequence of Machines
        Every two entries of one dataset.
    """

    entries: Sequence[Entry]
    rankings: Comparison
    machines: Sequence[Machines]

    def __repr__(self) -> str:
        names = ", ".join(entry.name for entry in self.entries)
        return f"ComparedResults: {count(len(self.entries), 'ranking')}, {names}"

    def _repr_html_(self) -> str:
        return as_html(repr(self), self.frame())

    def frame(self) -> pl.DataFrame:
        """One row a combination, with its score and rank in each entry, the most versatile first.

        Returns
        -------
        pl.DataFrame
            ``combination``; ``mean, min, spread`` of the scores; ``mean_rank, worst_rank``; and
            ``score_NAME, rank_NAME`` of each entry.
        """
        return self.rankings.versatility().rename({"alternative": "combination"})

    def factors(self) -> dict[str, object]:
        """How much longer each stage takes on the second machine: for ``recommend(device=)``.

        Raises
        ------
        ScoreError
            If these are not two entries of one dataset.
        """
        if len(self.entries) != 2 or self.entries[0].dataset != self.entries[1].dataset:
            raise ScoreError("`factors` needs two results of the same dataset, from two machines")
        here, there = self.entries
        return {
            "machine": there.machine,
            "measured_on": here.machine,
            "dataset": here.dataset,
            "stages": device_factors(here.rows, there.rows),
        }


def entries_of(
    results: Sequence[Stored],
    preset: str | None = None,
    *,
    criteria: Names | None = None,
    reconstruction: bool | None = False,
    **changes: object,
) -> list[Entry]:
    """Score every dataset in the results, separately for each machine.

    Parameters
    ----------
    results : sequence of Stored
    preset, criteria
        See `measured.table_of`.
    reconstruction : bool or None
        Whether to add the criteria of reconstruction, which all results must then have. None adds
        them if there is one dataset on one machine and most combinations were reconstructed.
    **changes
        Settings in place of the preset's; None keeps the preset's.

    Raises
    ------
    ScoreError
        If one of the results cannot be scored.
    """
    folders = [each.folder.resolve() for each in results]
    for folder in folders:
        if folders.count(folder) > 1:
            raise ScoreError(f"{folder} is given twice; give each result once")
    groups = [
        (source, names, rows)
        for source, each in enumerate(results)
        for names, rows in _by_dataset_and_machine(each.table())
    ]
    if reconstruction is None and len(groups) > 1:
        reconstruction = False
    preset = preset or _in_common([rows for _, _, rows in groups])
    models = [each.reconstructions() for each in results]
    found: list[tuple[Path, Entry]] = []
    for source, (dataset, machine), rows in groups:
        measured = table_of(
            MeasuredRows(rows, models[source]),
            preset,
            criteria=criteria,
            reconstruction=reconstruction,
        )
        scores = score(measured.table, settings_from(measured.preset, **changes))
        known = dataset in models[source]["dataset"]
        name = measured.preset.name
        entry = Entry(dataset, dataset, machine, rows, scores, name, known, source)
        found.append((results[source].folder, entry))
    presets = sorted({entry.preset for _, entry in found})
    if len(presets) > 1:
        raise ScoreError(
            f"the results suit different presets ({', '.join(presets)}); choose one with `preset`"
        )
    return _with_names(found)


def _in_common(groups: Sequence[pl.DataFrame]) -> str | None:
    """By inliers where only some have references, so that all are scored alike; None: as each."""
    suitable = {suitable_preset(rows).name for rows in groups}
    tested = all(has_chance_test(rows) for rows in groups)
    return "inliers" if suitable == {"default", "inliers"} and tested else None


def _by_dataset_and_machine(
    rows: pl.DataFrame,
) -> list[tuple[tuple[str, str], pl.DataFrame]]:
    groups = rows.group_by("dataset", "machine", maintain_order=True)
    return [
        ((str(dataset), str(machine or UNKNOWN_MACHINE)), group)
        for (dataset, machine), group in groups
    ]


def _with_names(found: Sequence[tuple[Path, Entry]]) -> list[Entry]:
    """The shortest names that are unique."""
    for form in ("{dataset}", "{dataset} ({machine})", "{folder}", "{folder} {dataset}"):
        names = [
            form.format(dataset=entry.dataset, machine=entry.machine, folder=folder.name)
            for folder, entry in found
        ]
        if len(set(names)) == len(names):
            break
    else:
        names = [f"{number + 1} {entry.dataset}" for number, (_, entry) in enumerate(found)]
    return [replace(entry, name=name) for name, (_, entry) in zip(names, found, strict=True)]


def compare_entries(entries: Sequence[Entry], over: Over = "pairwise") -> ComparedResults:
    """Compare all entries, and those of one dataset on several machines."""
    return ComparedResults(
        entries, compare_datasets(entries, over), compare_machines(entries, over)
    )


def compare_datasets(entries: Sequence[Entry], over: Over = "pairwise") -> Comparison:
    """Compare the rankings of all entries; see `comparison.compare`."""
    rankings = {entry.name: entry.scores for entry in entries}
    return compare(rankings, over, [entry.dataset for entry in entries])


def compare_machines(entries: Sequence[Entry], over: Over = "pairwise") -> list[Machines]:
    """Compare all pairs of entries with the same dataset on different machines."""
    return [
        _two_machines(first, second, over)
        for first, second in combinations(entries, 2)
        if first.dataset == second.dataset and first.machine != second.machine
    ]


def _two_machines(first: Entry, second: Entry, over: Over) -> Machines:
    rankings: Mapping[str, Scores] = {first.name: first.scores, second.name: second.scores}
    try:
        times: pl.DataFrame | str = compare_times(first.rows, second.rows)
    except ScoreError as error:
        times = str(error)
    return Machines(first, second, compare(rankings, over), times)
