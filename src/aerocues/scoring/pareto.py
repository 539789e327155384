"""The Pareto front: alternatives that no other one dominates."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from aerocues.errors import ScoreError
from aerocues.scoring.cues import Scores


def pareto_front(values: NDArray[np.float64]) -> NDArray[np.bool_]:
    """The points that no other point dominates.

    Parameters
    ----------
    values : (alternatives, criteria) float64
        Higher is better; points with NaN are excluded.

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
    """Indices of the alternatives on the Pareto front of two criteria, sorted by the first.

    The front uses normalised values, in which failures count as the settings say: a combination
    that fails on most pairs is not on the front for its few good ones.

    Raises
    ------
    ScoreError
        If a criterion is not in the table.
    """
    names = scores.table.criterion_names
    for name in (first, second):
        if name not in names:
            raise ScoreError(f"the table has no criterion {name!r}; choose from {', '.join(names)}")
    chosen = [names.index(first), names.index(second)]
    values = scores.normalised[:, chosen]
    positions = np.flatnonzero(pareto_front(values))
    return positions[np.argsort(-values[positions, 0], kind="stable")]
