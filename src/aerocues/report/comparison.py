"""Comparison of entries: rankings across datasets, times across machines."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from aerocues.errors import ScoreError
from aerocues.scoring.across import Entry, compare_datasets, machines_of, times_between
from aerocues.scoring.comparison import Comparison
from aerocues.scoring.cues import rank

OF_SUMMARY = ("alternative", "mean", "min", "spread", "mean_rank", "worst_rank")


def comparison_of(entries: Sequence[Entry]) -> Comparison | None:
    """The rankings side by side; None for a single entry or without shared combinations."""
    if len(entries) < 2:
        return None
    try:
        return compare_datasets(entries)
    except ScoreError:
        return None


def comparison_facts(entries: Sequence[Entry]) -> dict[str, Any] | None:
    """Rank correlations of the entries, and the versatility of each combination."""
    comparison = comparison_of(entries)
    if comparison is None:
        return None
    ranks = rank(comparison.scores)
    known = (~np.isnan(comparison.scores)).sum(axis=0)
    position = {name: number for number, name in enumerate(comparison.alternatives)}
    return {
        "names": comparison.names,
        "spearman": comparison.spearman(),
        "kendall": comparison.kendall(),
        "shared": comparison.shared(),
        "versatility": [
            {
                **{name: row[name] for name in OF_SUMMARY},
                "rankings": known[position[row["alternative"]]],
                "scores": comparison.scores[:, position[row["alternative"]]],
                "ranks": ranks[:, position[row["alternative"]]],
            }
            for row in comparison.versatility().to_dicts()
        ],
    }


def machine_facts(entries: Sequence[Entry]) -> list[dict[str, Any]]:
    """All pairs of entries with the same dataset on different machines."""
    facts = []
    for first, second in machines_of(entries):
        try:
            rankings = compare_datasets([first, second])
        except ScoreError:
            # They share no combination.
            continue
        times = times_between(first, second)
        facts.append(
            {
                "first": first.name,
                "second": second.name,
                "spearman": rankings.spearman()[0, 1],
                "kendall": rankings.kendall()[0, 1],
                "times": {"unavailable": times} if isinstance(times, str) else times.to_dicts(),
            }
        )
    return facts
