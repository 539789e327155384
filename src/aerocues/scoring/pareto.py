"""Alternatives that no other one beats in two respects at once."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from aerocues.errors import ScoreError
from aerocues.scoring.cues import Scores


def pareto_front(values: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Which points no other one dominates.

    Parameters
    ----------
    values : (alternatives, criteria) float64
        Higher is better; a point with NaN takes no part.

    Returns
    -------
    (alternatives,) bool
    """
    front = np.array(~np.isnan(values).any(axis=1), dtype=np.bool_)
    candidates = np.flatnonzero(front)
    for position in candidates:
        others = values[candidates]
        better = (others >= values[position]).all(axis=1) & (others > values[position]).any(axis=1)
        front[position] = not better.any()
    return front


def pareto_of_criteria(scores: Scores, first: str, second: str) -> NDArray[np.int64]:
    """Positions on the Pareto front of two criteria, by the first, best first.

    It goes by the normalised values, in which failures count as the settings say: a combination
    that is good on the few pairs it does not fail on is not on the front for that.

    Raises
    ------
    ScoreError
        If a criterion is not in the table.
    """
    names = scores.table.criterion_names
    for name in (first, second):
        if name not in names:
            raise ScoreError(f"there is no criterion {name!r} here; choose from {', '.join(names)}")
    chosen = [names.index(first), names.index(second)]
    values = scores.normalised[:, chosen]
    positions = np.flatnonzero(pareto_front(values))
    return positions[np.argsort(-values[positions, 0], kind="stable")]
