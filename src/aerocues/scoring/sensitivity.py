"""How much the ranking depends on choices: alpha, aggregation, each criterion."""

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
    """Rankings under variants of one choice.

    Attributes
    ----------
    names : tuple of str
    correlation : (variants, variants) float64
        Spearman's rank correlation of the scores; NaN where it is not defined.
    best : tuple of str
        The best alternative of each.
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
    """Rankings under several powers of the normalised values."""
    chosen = dict.fromkeys((*sorted({*alphas, scores.settings.alpha}),))
    return _variants(
        {
            f"{alpha:g}": score(scores.table, replace(scores.settings, alpha=alpha))
            for alpha in chosen
        }
    )


def by_aggregation(scores: Scores) -> Variants:
    """Rankings under every way to aggregate the weights."""
    return _variants(
        {
            name: score(scores.table, replace(scores.settings, aggregation=name))
            for name in AGGREGATIONS
        }
    )


def by_criterion_left_out(scores: Scores) -> Variants:
    """Rankings without each criterion in turn; the first is that with all."""
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
