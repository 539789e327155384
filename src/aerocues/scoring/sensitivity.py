"""Sensitivity of the ranking to alpha, to the aggregation and to each criterion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from aerocues.scoring.aggregation import AGGREGATIONS
from aerocues.scoring.correlation import rank_correlation
from aerocues.scoring.cues import Scores, score

Array = NDArray[np.float64]
ALPHAS = (0.1, 0.25, 0.5, 0.75)


@dataclass(frozen=True)
class Variants:
    """Rankings under variants of one setting.

    Attributes
    ----------
    names : tuple of str
    correlation : (variants, variants) float64
        Spearman's rank correlation of the scores; NaN if undefined.
    best : tuple of str
        Best alternative of each variant.
    """

    names: tuple[str, ...]
    correlation: Array
    best: tuple[str, ...]


def _variants(named: dict[str, Scores]) -> Variants:
    columns = np.stack([scores.scores for scores in named.values()])
    return Variants(
        names=tuple(named),
        correlation=rank_correlation(columns),
        best=tuple(scores.table.alternatives[scores.best] for scores in named.values()),
    )


def by_alpha(scores: Scores, alphas: Sequence[float] = ALPHAS) -> Variants:
    """Rankings with several powers of the normalised values."""
    chosen = dict.fromkeys((*sorted({*alphas, scores.settings.alpha}),))
    return _variants(
        {
            f"{alpha:g}": score(scores.table, replace(scores.settings, alpha=alpha))
            for alpha in chosen
        }
    )


def by_aggregation(scores: Scores) -> Variants:
    """Rankings with every aggregation of the weights."""
    return _variants(
        {
            name: score(scores.table, replace(scores.settings, aggregation=name))
            for name in AGGREGATIONS
        }
    )


def by_criterion_left_out(scores: Scores) -> Variants:
    """The ranking with all criteria, then the rankings without each criterion in turn."""
    names = scores.table.criterion_names
    left_out = names if len(names) > 1 else ()
    return _variants(
        {
            "all criteria": scores,
            **{
                f"without {name}": score(scores.table.without_criterion(name), scores.settings)
                for name in left_out
            },
        }
    )


def mean_correlation(found: Sequence[Variants]) -> Array:
    """(variants, variants) mean over datasets of the correlations under the same variants.

    NaN where no dataset has a defined one, or the variants differ.
    """
    if len({each.names for each in found}) != 1:
        return np.full((len(found[0].names),) * 2, np.nan)
    stacked = np.stack([each.correlation for each in found])
    known = ~np.isnan(stacked)
    total, number = np.where(known, stacked, 0).sum(axis=0), known.sum(axis=0)
    mean = np.full(total.shape, np.nan)
    return np.asarray(np.divide(total, number, out=mean, where=number > 0))
