"""Results folders as entries that can be compared: each dataset as one machine measured it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from aerocues.errors import ScoreError
from aerocues.scoring.combinations import has_chance_test, suitable_preset
from aerocues.scoring.comparison import Comparison, Over, compare
from aerocues.scoring.conditions import CONDITIONS, conditions_of
from aerocues.scoring.cues import Scores, score
from aerocues.scoring.measured import (
    Measured,
    MeasuredRows,
    refuse_repeated,
    settings_from,
    table_of,
)
from aerocues.scoring.platforms import compare_times
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

    @property
    def settings(self) -> dict[str, Any]:
        """Configuration, versions and machine of the latest run."""
        ...


@dataclass(frozen=True)
class Entry:
    """One dataset, measured by one machine.

    Attributes
    ----------
    name : str
        The dataset; with the condition that differs or the folder if that alone is ambiguous.
    dataset, machine : str
    rows : pl.DataFrame
    scores : Scores
    preset : str
    reconstructed : bool
        Whether it has reconstructions.
    source : int
        Index of the results that it comes from.
    conditions : mapping of str to str
        What it was measured under; see `conditions.CONDITIONS`.
    """

    name: str
    dataset: str
    machine: str
    rows: pl.DataFrame
    scores: Scores
    preset: str
    reconstructed: bool = False
    source: int = 0
    conditions: Mapping[str, str] = field(default_factory=dict)

    @property
    def criteria_of_models(self) -> int:
        """How many criteria of its 3D models it is scored by."""
        return sum(criterion.reconstruction for criterion in self.scores.table.criteria)


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
        Whether to add the criteria of reconstruction where a dataset was reconstructed; at least
        one must be. None adds them if there is one dataset on one machine and most combinations
        were reconstructed.
    **changes
        Settings in place of the preset's; None keeps the preset's.

    Raises
    ------
    ScoreError
        If one of the results cannot be scored.
    """
    refuse_repeated(results)
    groups = [
        (source, names, rows)
        for source, each in enumerate(results)
        for names, rows in _by_dataset_and_machine(each.table())
    ]
    if reconstruction is None and len(groups) > 1:
        reconstruction = False
    preset = preset or _in_common([rows for _, _, rows in groups])
    models = [each.reconstructions() for each in results]
    modelled = [dataset in models[source]["dataset"] for source, (dataset, _), _ in groups]
    found: list[tuple[Path, Entry]] = []
    for known, (source, (dataset, machine), rows) in zip(modelled, groups, strict=True):
        measured = table_of(
            MeasuredRows(rows, models[source]),
            preset,
            criteria=criteria,
            reconstruction=known if reconstruction and any(modelled) else reconstruction,
        )
        scores = score(measured.table, settings_from(measured.preset, **changes))
        name = measured.preset.name
        conditions = conditions_of(rows, results[source].settings)
        entry = Entry(dataset, dataset, machine, rows, scores, name, known, source, conditions)
        found.append((results[source].folder, entry))
    _refuse_different_presets([entry for _, entry in found])
    return _with_names(found)


def _refuse_different_presets(entries: Sequence[Entry]) -> None:
    presets = sorted({entry.preset for entry in entries})
    if len(presets) > 1:
        raise ScoreError(
            f"the results suit different presets ({', '.join(presets)}); choose one with `preset`"
        )


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
    for names in _forms(found):
        if len(set(names)) == len(names):
            return [replace(each, name=name) for name, (_, each) in zip(names, found, strict=True)]
    return [
        replace(entry, name=f"{number + 1} {entry.dataset}")
        for number, (_, entry) in enumerate(found)
    ]


def _forms(found: Sequence[tuple[Path, Entry]]) -> Iterator[list[str]]:
    yield [entry.dataset for _, entry in found]
    yield [f"{entry.dataset} ({entry.machine})" for _, entry in found]
    for condition in CONDITIONS:
        told = [condition.told(entry.conditions.get(condition.name, "?")) for _, entry in found]
        yield [f"{entry.dataset} ({text})" for text, (_, entry) in zip(told, found, strict=True)]
    yield [folder.name for folder, _ in found]
    yield [f"{folder.name} {entry.dataset}" for folder, entry in found]


def compare_datasets(entries: Sequence[Entry], over: Over = "pairwise") -> Comparison:
    """Compare the rankings of all entries; see `comparison.compare`."""
    rankings = {entry.name: entry.scores for entry in entries}
    return compare(rankings, over, [entry.dataset for entry in entries])


def times_between(first: Entry, second: Entry) -> pl.DataFrame | str:
    """See `platforms.compare_times`; a text says why times cannot be compared."""
    try:
        return compare_times(first.rows, second.rows)
    except ScoreError as error:
        return str(error)


def machines_of(entries: Sequence[Entry]) -> list[tuple[Entry, Entry]]:
    """All pairs of entries with the same dataset on different machines."""
    return [
        (first, second)
        for first, second in combinations(entries, 2)
        if first.dataset == second.dataset and first.machine != second.machine
    ]
