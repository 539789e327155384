"""Medians of each combination over its pairs: counts, ratios and times."""

from __future__ import annotations

from typing import TYPE_CHECKING

from aerocues.results.combination_columns import combination_name

if TYPE_CHECKING:
    import polars as pl

PAIR = ("dataset", "image_1", "image_2")


def one_image_seconds(stage: str) -> pl.Expr:
    """Median seconds of ``detect`` or ``describe`` per image (mean of the two images of a pair)."""
    import polars as pl

    both = pl.col(f"{stage}_seconds_1") + pl.col(f"{stage}_seconds_2")
    return (both / 2).median().alias(f"{stage}_seconds")


def combination_medians(table: pl.DataFrame, top: int | None = None) -> pl.DataFrame:
    """Medians of each combination over all pairs, the highest inlier ratio first.

    Parameters
    ----------
    table : pl.DataFrame
        Rows of one dataset from `Results.table`.
    top : int, optional
        Number of rows to keep; all by default.

    Returns
    -------
    pl.DataFrame
        One row per combination, the best first: ``combination, pairs, success_rate``; the medians
        ``precision, matches, inliers``, in which a pair whose status is not ``ok`` counts as 0;
        and the medians in seconds over the pairs with times, ``total_seconds,
        detect_seconds, describe_seconds`` (one image: the mean of the two), ``match_seconds,
        verify_seconds``. Ties are broken by inliers, then matches, then the name.
    """
    import polars as pl

    succeeded = pl.col("status") == "ok"

    def counted(name: str) -> pl.Expr:
        value = pl.when(succeeded).then(pl.col(name)).otherwise(0)
        return value.fill_null(0).median().alias(name)

    return (
        table.group_by(combination_name())
        .agg(
            pl.struct(PAIR).n_unique().alias("pairs"),
            succeeded.mean().alias("success_rate"),
            counted("precision"),
            counted("matches"),
            counted("inliers"),
            pl.col("total_seconds").median(),
            one_image_seconds("detect"),
            one_image_seconds("describe"),
            pl.col("match_seconds", "verify_seconds").median(),
        )
        .sort(
            "precision",
            "inliers",
            "matches",
            "combination",
            descending=[True, True, True, False],
        )
        .head(top if top is not None else len(table))
    )
