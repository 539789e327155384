"""The best alternatives of each dataset, and which of them stay good on the others."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from aerocues.scoring.comparison import Comparison
from aerocues.scoring.cues import rank

if TYPE_CHECKING:
    import polars as pl

TOP = 10
SHARE = 0.1
"""Best share of each dataset to which a consistently good alternative belongs."""


def best_of_each(comparison: Comparison) -> pl.DataFrame:
    """The best alternative of each dataset.

    Returns
    -------
    pl.DataFrame
        One row per dataset: ``dataset, best, score``, ``scored`` (number of alternatives with a
        score) and ``mean_elsewhere`` (mean score of the best on the other datasets; null where
        it has none).
    """
    import polars as pl

    scores = comparison.by_dataset(comparison.scores)
    rows = []
    for position, name in enumerate(comparison.dataset_names):
        best = int(np.nanargmax(scores[position]))
        others = np.delete(scores[:, best], position)
        known = others[~np.isnan(others)]
        rows.append(
            {
                "dataset": name,
                "best": comparison.alternatives[best],
                "score": float(scores[position, best]),
                "scored": int((~np.isnan(scores[position])).sum()),
                "mean_elsewhere": float(known.mean()) if len(known) else None,
            }
        )
    return pl.DataFrame(rows)


def kept_in_top(comparison: Comparison, top: int = TOP) -> NDArray[np.int64]:
    """How many of the first alternatives of one dataset are also first on another.

    Returns
    -------
    (datasets, datasets) int64
        On the diagonal, how many there are: more than `top` with ties.
    """
    first = (rank(comparison.by_dataset(comparison.scores)) <= top).astype(np.int64)
    return np.asarray(first @ first.T)


def consistently_good(comparison: Comparison, share: float = SHARE) -> pl.DataFrame:
    """Alternatives among the best share of every dataset, the best mean first.

    Returns
    -------
    pl.DataFrame
        ``alternative, mean, min``, ``variation`` (standard deviation / mean) and ``worst_rank``.
    """
    import polars as pl

    scores = comparison.by_dataset(comparison.scores)
    ranks = rank(scores)
    places = share * (~np.isnan(scores)).sum(axis=1, keepdims=True)
    good = np.flatnonzero((ranks <= places).all(axis=0))
    chosen = scores[:, good]
    return pl.DataFrame(
        {
            "alternative": [comparison.alternatives[position] for position in good],
            "mean": chosen.mean(axis=0),
            "min": chosen.min(axis=0) if len(good) else [],
            "variation": chosen.std(axis=0) / chosen.mean(axis=0),
            "worst_rank": ranks[:, good].max(axis=0) if len(good) else [],
        },
        schema_overrides={"alternative": pl.String, "min": pl.Float64, "worst_rank": pl.Float64},
    ).sort("mean", "alternative", descending=[True, False])
