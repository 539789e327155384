"""Figures of image pairs for each combination, to be compared with those of models."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from aerocues.errors import ScoreError
from aerocues.results.combination_columns import COMBINATION
from aerocues.scoring.combinations import (
    SUCCESS,
    SUCCESS_WITHOUT_CHANCE_TEST,
    decision_table,
    has_reference,
)
from aerocues.scoring.criteria import (
    EXACT_MATCHES,
    EXPECTED_QUALITY,
    RIGHT_MATCHES,
    criteria_named,
)
from aerocues.scoring.long_form import values_of

if TYPE_CHECKING:
    import polars as pl

SUCCESS_RATE = "success_rate"
LINK_COVERAGE = "links_x_coverage"
LINK_QUALITY = "links_x_expected_quality"
OF_LINKS = ("coverage", RIGHT_MATCHES, EXACT_MATCHES, "reference_turn")
LINKED = {"coverage": LINK_COVERAGE, EXPECTED_QUALITY: LINK_QUALITY}
"""Means that are multiplied by the links, and what the products are called."""
# Of several thresholds of the ground truth only the middle one: the others are almost redundant.
CRITERIA = (
    "inliers",
    "matches",
    "precision",
    "recall",
    "repeatability",
    "f1_score",
    "excess_inliers",
    "precision_beyond_chance",
    "recall_beyond_chance",
    "repeatability_beyond_chance",
    "f1_beyond_chance",
    "total_seconds",
    "ref_matches@3",
    "ref_matching_score@3",
    "ref_precision@3",
    "ref_repeatability",
    "coverage",
    "sharpness",
    "seconds_per_1k_ref_matches",
    "gt_precision@3",
    "gt_matching_score@3",
    "gt_repeatability",
    "homography_auc@3",
    "pose_auc@10",
)


def figures_of_pairs(rows: pl.DataFrame, *, chance_fails: bool) -> pl.DataFrame:
    """The figures of each combination on the pairs of one dataset.

    Parameters
    ----------
    rows : pl.DataFrame
        Measured rows, with the name of the combination in a column.
    chance_fails : bool
        Whether pairs that do not beat chance have failed.

    Returns
    -------
    pl.DataFrame
        One row per combination: the share of its successful pairs, means over these of what was
        measured, and, where pairs have a reference, links by class of pairs times coverage and
        times the expected quality.
    """
    import polars as pl

    success = pl.col("status").is_in(SUCCESS if chance_fails else SUCCESS_WITHOUT_CHANCE_TEST)
    known: list[pl.Series] = []
    for criterion in criteria_named(CRITERIA):
        try:
            values = values_of(rows, criterion).cast(pl.Float64)
        except ScoreError:
            continue  # not measured
        known.append(values.alias(criterion.name))
    names = [values.name for values in known]
    means = (
        rows.select(COMBINATION, success.alias(SUCCESS_RATE))
        .with_columns(known)
        .group_by(COMBINATION)
        .agg(
            pl.col(SUCCESS_RATE).cast(pl.Float64).mean(),
            pl.col(names).filter(pl.col(SUCCESS_RATE) & pl.col(names).is_finite()).mean(),
        )
    )
    if not (has_reference(rows) and set(OF_LINKS) <= set(rows.columns)):
        return means
    return means.join(_linked(rows, chance_fails=chance_fails), on=COMBINATION, how="left")


def _linked(rows: pl.DataFrame, *, chance_fails: bool) -> pl.DataFrame:
    """Links by class of pairs times means: failed pairs link nothing and have no right match."""
    import polars as pl

    criteria = criteria_named(tuple(LINKED))
    table = decision_table(rows, criteria, chance_fails=chance_fails, links=True)
    assert table.links is not None
    pairs = np.maximum(table.tried, 1)
    means = np.nan_to_num(table.values).sum(axis=1) / pairs[:, None]
    links = table.links.factor(np.ones((1, len(table.repeats))))[0]
    figures = dict(zip(LINKED.values(), (links[:, None] * means).T, strict=True))
    return pl.DataFrame({COMBINATION: table.alternatives, **figures})
