"""The Composite Unsupervised Efficiency Score (CUES)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aerocues.errors import ScoreError
from aerocues.scoring.aggregation import aggregate
from aerocues.scoring.normalisation import Means, normalise, plain_means
from aerocues.scoring.settings import ScoreSettings
from aerocues.scoring.table import DecisionTable
from aerocues.scoring.weights import weights_by_method

Array = NDArray[np.float64]
DIGITS = 12


@dataclass(frozen=True)
class BatchScores:
    """Scores of a batch of resamples.

    Attributes
    ----------
    scores : (batch, alternatives) float64
        In [0, 1]; NaN for an alternative without a value in some criterion.
    by_method : (batch, methods, criteria) float64
        Weights by each method.
    weights : (batch, criteria) float64
        Aggregated weights.
    normalised : (batch, alternatives, criteria) float64
        Values whose weighted sums are the scores.
    """

    scores: Array
    by_method: Array
    weights: Array
    normalised: Array


@dataclass(frozen=True)
class Scores:
    """CUES of every alternative.

    Attributes
    ----------
    table : DecisionTable
    settings : ScoreSettings
    means : (alternatives, criteria) float64
        Means over the repeats with a value.
    normalised : (alternatives, criteria) float64
        In [0, 1] (1 is the best), to the power alpha.
    by_method : (methods, criteria) float64
    weights : (criteria,) float64
    scores : (alternatives,) float64
        NaN for an alternative without a value in some criterion.
    ranks : (alternatives,) float64
        1 is the best; ties share the best rank; NaN without a score.
    """

    table: DecisionTable
    settings: ScoreSettings
    means: Array
    normalised: Array
    by_method: Array
    weights: Array
    scores: Array
    ranks: Array

    @property
    def order(self) -> NDArray[np.int64]:
        """Indices of the scored alternatives, the best first; ties are sorted by name."""
        positions = [each for each in range(len(self.ranks)) if not np.isnan(self.ranks[each])]
        positions.sort(key=lambda each: (self.ranks[each], self.table.alternatives[each]))
        return np.array(positions, dtype=np.int64)

    @property
    def best(self) -> int:
        """Index of the best alternative."""
        return int(self.order[0])


def score_batch(means: Means, table: DecisionTable, settings: ScoreSettings) -> BatchScores:
    """Score a batch of resamples, weights estimated anew in each."""
    normalised = normalise(means, table, settings) ** settings.alpha
    by_method = weights_by_method(normalised, settings.weights)
    weights = aggregate(by_method, settings.aggregation)
    return BatchScores(
        scores=np.einsum("bac,bc->ba", normalised, weights) * means.links,
        by_method=by_method,
        weights=weights,
        normalised=normalised,
    )


def rank(scores: Array) -> Array:
    """Ranks along the last axis: 1 for the highest, ties share the best rank, NaN stays NaN.

    Scores are rounded to 12 digits first, so that rounding errors do not break ties.
    """
    values = -np.round(np.asarray(scores, np.float64), DIGITS)
    order = np.argsort(values, axis=-1, kind="stable")  # NaN come last
    ordered = np.take_along_axis(values, order, axis=-1)
    first = np.ones(ordered.shape, np.bool_)
    first[..., 1:] = ordered[..., 1:] != ordered[..., :-1]
    places = np.arange(1, ordered.shape[-1] + 1)
    ranks = np.empty(ordered.shape)
    np.put_along_axis(
        ranks, order, np.maximum.accumulate(np.where(first, places, 0), axis=-1), axis=-1
    )
    return np.where(np.isnan(values), np.nan, ranks)


def score(table: DecisionTable, settings: ScoreSettings | None = None) -> Scores:
    """Score the alternatives of a table.

    1. Bounds: the smallest and largest value of each criterion over all repeats of all
       alternatives.
    2. Mean of each criterion over the repeats of each alternative.
    3. ``z = (mean - min) / (max - min)``, for a cost ``1 - z``; then ``x = z ** alpha``.
    4. Weights of the criteria from the matrix ``x``, by each method; their aggregate ``w``.
    5. ``CUES = sum(w * x)``, times the factor of the links where the table has them.

    Parameters
    ----------
    table : DecisionTable
    settings : ScoreSettings, optional

    Raises
    ------
    ScoreError
        If no alternative has a value in every criterion.
    """
    settings = settings or ScoreSettings()
    means = plain_means(table)
    batch = score_batch(means, table, settings)
    if np.isnan(batch.scores).all():
        raise ScoreError(
            "no alternative has a value in every criterion; choose fewer criteria, or count "
            "failures as the worst"
        )
    return Scores(
        table=table,
        settings=settings,
        means=means.mean[0],
        normalised=batch.normalised[0],
        by_method=batch.by_method[0],
        weights=batch.weights[0],
        scores=batch.scores[0],
        ranks=rank(batch.scores[0]),
    )
