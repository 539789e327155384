"""Rankings of the same alternatives by other methods of multi-criteria decision making.

All except COPRAS come from pymcdm and are independent of our code. Their input is the normalised
criteria before the power alpha, and the weights of the score.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aerocues.errors import MethodUnavailableError
from aerocues.scoring.correlation import rank_correlation
from aerocues.scoring.cues import Scores

Array = NDArray[np.float64]
LEAST_COST = 1e-9


def _copras(matrix: Array, weights: Array, types: NDArray[np.int64]) -> Array:
    """COPRAS (Zavadskas and Kaklauskas 1996); pymcdm's version adds costs to benefits."""
    weighted = weights * matrix / matrix.sum(axis=0)
    benefit, cost = weighted[:, types > 0].sum(axis=1), weighted[:, types < 0].sum(axis=1)
    # The limit avoids a division by zero: an alternative without cost gets the full cost term.
    inverse = 1 / np.maximum(cost, LEAST_COST)
    return np.asarray(benefit + cost.sum() * inverse / inverse.sum())


@dataclass(frozen=True)
class RankingMethod:
    """One ranking method.

    Attributes
    ----------
    name : str
    kind : str or callable
        Class in pymcdm, or a function of matrix, weights and types (-1 for costs).
    arguments : tuple
        Arguments of the class.
    higher_is_better : bool
        Whether higher preferences are better.
    needs_costs : bool
        Whether costs remain costs (at least one is needed); otherwise all criteria are benefits.
    """

    name: str
    kind: str | Callable[[Array, Array, NDArray[np.int64]], Array]
    arguments: tuple[Any, ...] = ()
    higher_is_better: bool = True
    needs_costs: bool = False


RANKING_METHODS: tuple[RankingMethod, ...] = (
    RankingMethod("TOPSIS", "TOPSIS"),
    RankingMethod("VIKOR", "VIKOR", higher_is_better=False),
    RankingMethod("PROMETHEE II", "PROMETHEE_II", ("usual",)),
    RankingMethod("COPRAS", _copras, needs_costs=True),
    RankingMethod("MOORA", "MOORA", needs_costs=True),
)


@dataclass(frozen=True)
class Agreement:
    """Spearman's rank correlation of CUES with other methods.

    Attributes
    ----------
    names : tuple of str
        CUES first.
    correlation : (methods, methods) float64
    best : tuple of str
        Best alternative by each method.
    """

    names: tuple[str, ...]
    correlation: Array
    best: tuple[str, ...]


def agreement(scores: Scores) -> Agreement:
    """Rank the alternatives by other methods, and correlate the rankings.

    Raises
    ------
    MethodUnavailableError
        If pymcdm is not installed.
    """
    taking_part = np.flatnonzero(~np.isnan(scores.scores))
    matrix = scores.normalised[taking_part] ** (1 / scores.settings.alpha)
    # A constant criterion has no information, and the normalisations divide by its range.
    kept = (scores.weights > 0) & (np.ptp(matrix, axis=0) > 0)
    weights, is_cost = scores.weights[kept], scores.table.is_cost[kept]
    rows = [scores.scores[taking_part]]
    rows += [_preferences(method, matrix[:, kept], weights, is_cost) for method in RANKING_METHODS]
    names = [scores.table.alternatives[position] for position in taking_part]
    return Agreement(
        names=("CUES", *(method.name for method in RANKING_METHODS)),
        correlation=rank_correlation(np.stack(rows)),
        best=tuple("" if np.isnan(row).all() else names[int(np.nanargmax(row))] for row in rows),
    )


def _preferences(
    method: RankingMethod, matrix: Array, weights: Array, is_cost: NDArray[np.bool_]
) -> Array:
    """Preferences (higher is better); NaN if the method is undefined."""
    try:
        from pymcdm import methods
    except ImportError as error:
        raise MethodUnavailableError(
            f"agreement with other methods needs pymcdm ({error}); install aerocues[validation]"
        ) from error
    if not len(weights) or (method.needs_costs and not is_cost.any()):
        return np.full(len(matrix), np.nan)
    costs = is_cost & method.needs_costs
    values = np.where(costs, 1 - matrix, matrix)
    kind = method.kind
    ranking = getattr(methods, kind)(*method.arguments) if isinstance(kind, str) else kind
    with np.errstate(divide="ignore", invalid="ignore"), warnings.catch_warnings():
        # PROMETHEE warns of alternatives that are better or worse than all others in everything.
        warnings.filterwarnings("ignore", "Alternatives with indices", UserWarning)
        found = ranking(values, weights / weights.sum(), np.where(costs, -1, 1))
    preferences = np.asarray(found, dtype=np.float64)
    return preferences if method.higher_is_better else -preferences
