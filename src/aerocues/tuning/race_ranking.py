"""The ranking after a race, with what was measured of each combination."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from aerocues.methods.combination import Combination
from aerocues.results.combination_columns import combination_name
from aerocues.results.medians import one_image_seconds
from aerocues.tuning.device import Device
from aerocues.tuning.image_evaluator import rows_frame
from aerocues.tuning.pair_evaluator import PairEvaluator
from aerocues.tuning.race import RaceOutcome

if TYPE_CHECKING:
    import polars as pl

MEDIANS = (
    *("precision_beyond_chance", "precision", "excess_inliers", "inliers"),
    *("ref_precision@3", "ref_matches@3", "coverage"),
)


def race_ranking(
    evaluator: PairEvaluator,
    combinations: Sequence[Combination],
    pairs: Sequence[int],
    outcome: RaceOutcome,
    device: Device | None,
) -> pl.DataFrame:
    """One row per combination that succeeded on a pair; see `recommend.Recommendation`."""
    import polars as pl

    rows = [
        row
        for a, p in np.argwhere(outcome.known)
        if (row := evaluator.row((pairs[p], combinations[a]))) is not None
    ]
    table = rows_frame([device.there(row) if device else row for row in rows])
    scores = pl.DataFrame(
        {
            "combination": [str(each) for each in combinations],
            "score": outcome.scores,
            "probability": outcome.probability,
        }
    )
    succeeded = pl.col("status") == "ok"

    return (
        table.group_by(combination_name())
        .agg(
            pl.len().alias("pairs"),
            succeeded.sum().alias("succeeded"),
            *(pl.when(succeeded).then(pl.col(name)).median().alias(name) for name in MEDIANS),
            one_image_seconds("detect"),
            one_image_seconds("describe"),
            pl.col("match_seconds", "verify_seconds", "total_seconds").median(),
        )
        .filter(pl.col("succeeded") > 0)
        .join(scores, on="combination")
        .sort("score", "combination", descending=[True, False])
    )
