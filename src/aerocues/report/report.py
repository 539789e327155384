"""The report: from results folders to one page, figures or a short text."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from aerocues.errors import ScoreError
from aerocues.evaluation.results import Results
from aerocues.report.entry import ReportEntry
from aerocues.scoring.across import Entry, entries_of
from aerocues.scoring.bootstrap import RESAMPLES
from aerocues.scoring.ranking import rank_alternatives
from aerocues.scoring.validation import validate


def report_entries(
    results: Sequence[Results],
    preset: str | None = None,
    *,
    criteria: Sequence[str] | None = None,
    reconstruction: bool | None = None,
    resamples: int = RESAMPLES,
    seed: int = 0,
    **changes: object,
) -> list[ReportEntry]:
    """Score and validate every data set in some results, each machine by itself."""
    if not results:
        raise ScoreError("there are no results to report on; name a results folder")
    found = []
    for each, entry in _entries(results, preset, criteria, reconstruction, changes):
        scores = entry.scores
        ranking = rank_alternatives(scores.table, scores.settings, resamples=resamples, seed=seed)
        found.append(ReportEntry(entry, ranking, validate(scores, seed=seed), each.settings))
    return found


def _entries(
    results: Sequence[Results],
    preset: str | None,
    criteria: Sequence[str] | None,
    reconstruction: bool | None,
    changes: dict[str, Any],
) -> list[tuple[Results, Entry]]:
    entries = entries_of(
        results, preset, criteria=criteria, reconstruction=bool(reconstruction), **changes
    )
    by_rows = [(each, each.table()) for each in results]
    sources = [
        each for each, rows in by_rows for _ in range(rows.select("dataset", "machine").n_unique())
    ]
    return list(zip(sources, entries, strict=True))
