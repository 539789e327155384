"""Scores of finished measurements of one dataset under an objective, and of resamples."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from aerocues.scoring.combinations import decision_table, has_chance_test, suitable_preset
from aerocues.scoring.criteria import LINKS, criteria_named
from aerocues.scoring.objectives import TIME, Objective
from aerocues.scoring.resampling import draws, independent_units
from aerocues.scoring.table import DecisionTable
from aerocues.scoring.valuation import Valuation

if TYPE_CHECKING:
    import polars as pl

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class FinishedScores:
    """Scores of one dataset under an objective.

    Attributes
    ----------
    dataset, preset : str
    alternatives : tuple of str
    scores : (alternatives,) float64
    drawn : (resamples, alternatives) float64
        Scores on pairs that were drawn anew, with the bounds and weights of all of them.
    success_rate, measured_share : (alternatives,) float64
        Shares of the measured pairs, and of all pairs.
    pairs, units : int
        Pairs, and what of them is independent.
    """

    dataset: str
    preset: str
    alternatives: tuple[str, ...]
    scores: Array
    drawn: Array
    success_rate: Array
    measured_share: Array
    pairs: int
    units: int

    def __contains__(self, name: object) -> bool:
        return name in self.alternatives


def scores_of_finished(
    rows: pl.DataFrame, objective: Objective, resamples: int, seed: int
) -> FinishedScores:
    """Score the rows of one dataset under an objective.

    Parameters
    ----------
    rows : pl.DataFrame
    objective : Objective
    resamples, seed : int

    Raises
    ------
    ScoreError
        If a criterion that the objective needs was not measured.
    """
    references = suitable_preset(rows).name == "default"
    scoring = objective.scoring(references=references, chance_test=has_chance_test(rows))
    criteria = criteria_named(objective.criteria(scoring))
    table = decision_table(rows, criteria, chance_fails=scoring.chance_fails, links=scoring.links)
    values = filled(table)
    valuation = Valuation(
        values,
        criteria,
        table.blocks,
        scoring.settings,
        objective,
        classes=table.links.classes if table.links else None,
    )
    drawn = [valuation.of(values, counts) for (counts,) in draws(table, resamples, seed, 1)]
    return FinishedScores(
        dataset=str(rows["dataset"][0]),
        preset=scoring.name,
        alternatives=table.alternatives,
        scores=valuation.of(values),
        drawn=np.array(drawn),
        success_rate=table.success_rate,
        measured_share=table.tried / len(table.repeats),
        pairs=len(table.repeats),
        units=len(np.unique(independent_units(table))),
    )


def filled(table: DecisionTable) -> Array:
    """(A, P, C) values without gaps.

    A failed pair has the worst value of each criterion that was measured, and links nothing; its
    time is the mean of the alternative's others. A pair on which it was not measured has the
    mean of its others.
    """
    values = table.values.copy()
    missing: NDArray[np.bool_] = np.asarray(np.isnan(values))
    worst = np.where(table.is_cost, np.nanmax(values, axis=(0, 1)), np.nanmin(values, axis=(0, 1)))
    names = table.criterion_names
    if LINKS in names:
        worst[names.index(LINKS)] = 0.0
    failed = np.asarray(missing & table.tried_on[:, :, None])
    if TIME in names:
        time = names.index(TIME)
        never = np.asarray(missing[:, :, time].all(axis=1))
        failed[:, :, time] &= never[:, None]
    values = np.where(failed, worst, values)
    known = ~np.isnan(values)
    total, number = np.where(known, values, 0).sum(axis=1), known.sum(axis=1)
    mean = np.where(number > 0, total / np.maximum(number, 1), worst)
    return np.where(known, values, mean[:, None, :])
