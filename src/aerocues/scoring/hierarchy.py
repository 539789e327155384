"""Mean scores of each detector, descriptor, norm and matcher."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

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
            pl.col("score").mean().alias("mean"),
            pl.col("score").max().alias("max"),
            pl.col("score").std(ddof=0).alias("standard_deviation"),
            pl.len().alias("alternatives"),
            pl.col("tried").sum().alias("evaluations"),
            pl.col("alternative").sort_by("score", descending=True).first().alias("best"),
        )
        .sort("mean", "name", descending=[True, False])
        for component, labels in table.components.items()
    }
