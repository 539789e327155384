"""Mean scores of each detector, descriptor, norm and matcher, on one dataset and across several."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from aerocues.scoring.comparison import Comparison
from aerocues.scoring.cues import Scores

if TYPE_CHECKING:
    import polars as pl


def hierarchy(scores: Scores) -> dict[str, pl.DataFrame]:
    """Scores grouped by every set of labels in ``scores.table.components``.

    Returns
    -------
    dict of pl.DataFrame
        For each set, one row per label, the best mean first: ``name, mean, max,
        standard_deviation, alternatives, evaluations`` (alternatives x repeats measured) and
        ``best`` (the best alternative).
    """
    import polars as pl

    table = scores.table
    scored = scores.order
    frame = pl.DataFrame(
        {
            "alternative": [table.alternatives[position] for position in scored],
            "score": scores.scores[scored],
            "tried": table.tried[scored],
        }
    )
    return {
        component: frame.with_columns(
            pl.Series("name", np.array(labels)[scored].tolist(), dtype=pl.String)
        )
        .group_by("name")
        .agg(
            *_spread_of_scores(),
            pl.len().alias("alternatives"),
            pl.col("tried").sum().alias("evaluations"),
            pl.col("alternative").sort_by("score", descending=True).first().alias("best"),
        )
        .sort("mean", "name", descending=[True, False])
        for component, labels in table.components.items()
    }


def hierarchy_across(comparison: Comparison) -> dict[str, pl.DataFrame]:
    """Scores of all datasets together, grouped by every set of labels.

    Returns
    -------
    dict of pl.DataFrame
        For each set, one row per label, the best mean first: ``name, mean, max,
        standard_deviation, evaluations`` (scores: alternatives x datasets), ``best`` (the
        alternative with the highest score) and ``dataset`` (where it has it).
    """
    import polars as pl

    scores = comparison.by_dataset(comparison.scores)
    dataset, alternative = np.nonzero(~np.isnan(scores))
    frame = pl.DataFrame(
        {
            "score": scores[dataset, alternative],
            "alternative": np.array(comparison.alternatives)[alternative].tolist(),
            "dataset": np.array(comparison.dataset_names)[dataset].tolist(),
        }
    )
    highest = pl.col("score").arg_max()
    return {
        component: frame.with_columns(
            pl.Series("name", np.array(labels)[alternative].tolist(), dtype=pl.String)
        )
        .group_by("name")
        .agg(
            *_spread_of_scores(),
            pl.len().alias("evaluations"),
            pl.col("alternative").get(highest).alias("best"),
            pl.col("dataset").get(highest),
        )
        .sort("mean", "name", descending=[True, False])
        for component, labels in comparison.components.items()
    }


def _spread_of_scores() -> list[pl.Expr]:
    """Mean, largest and standard deviation of the column ``score``."""
    import polars as pl

    score = pl.col("score")
    return [
        score.mean().alias("mean"),
        score.max().alias("max"),
        score.std(ddof=0).alias("standard_deviation"),
    ]
