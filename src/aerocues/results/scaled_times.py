"""Times of pairs without exclusive timing, scaled by those of pairs with it.

Pairs that were timed on a core of their own were also measured beside others. For each combination
and stage, the ratio of the two sums scales the times of its other pairs: a ratio estimate (Cochran,
"Sampling Techniques", 1977, chapter 6).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from aerocues.results.combination_columns import METHODS
from aerocues.results.metrics import PER_THOUSAND, STAGES_OF_IMAGES, STAGES_OF_PAIRS

if TYPE_CHECKING:
    import polars as pl

SCALED = "scaled"
_GROUP = ("machine", *METHODS)
_STAGES = {
    **{stage: (f"{stage}_seconds_1", f"{stage}_seconds_2") for stage in STAGES_OF_IMAGES},
    **{stage: (f"{stage}_seconds",) for stage in STAGES_OF_PAIRS},
}
_SECONDS = tuple(
    f"{column}{ending}"
    for columns in _STAGES.values()
    for column in columns
    for ending in ("", "_cpu")
)
COLUMNS = ("row_key", "timing", "measured_at", *_GROUP, *_SECONDS)


def with_scaled_times(best: pl.DataFrame, measured: pl.DataFrame) -> pl.DataFrame:
    """Scale the times of rows if the same machine timed other rows of the combination exclusively.

    Parameters
    ----------
    best : pl.DataFrame
        The best row of each measurement; columns as in `schema.COLUMNS`.
    measured : pl.DataFrame
        All successful rows, including the same measurement with other timings; at least the
        `COLUMNS`.

    Returns
    -------
    pl.DataFrame
        `best`; in scaled rows ``timing`` is ``scaled``.
    """
    import polars as pl

    factors = _factors(measured.lazy()).collect()
    if factors.is_empty():
        return best
    rough = pl.col("timing").is_in(("shared", "estimated")) & pl.col("_scaled").is_not_null()
    counts = list(PER_THOUSAND.values())
    scaled = (
        best.lazy()
        .select("timing", *_GROUP, *_SECONDS, *PER_THOUSAND, *counts, "total_seconds")
        .join(factors.lazy(), on=_GROUP, how="left", maintain_order="left")
        .with_columns(
            pl.when(rough).then(pl.lit(SCALED)).otherwise("timing").alias("timing"),
            *(
                pl.when(rough & pl.col(factor).is_not_null())
                .then(pl.col(f"{column}_cpu") * pl.col(factor))
                .otherwise(name)
                .alias(name)
                for stage, columns in _STAGES.items()
                for column in columns
                for name, factor in (
                    (column, f"_{stage}_wall"),
                    (f"{column}_cpu", f"_{stage}_cpu"),
                )
            ),
        )
    )
    total, done = _total_seconds(), pl.col("timing") == SCALED
    scaled = scaled.with_columns(
        pl.when(done).then(total).otherwise("total_seconds").alias("total_seconds"),
        *(
            pl.when(done)
            .then(pl.when(pl.col(count) > 0).then(1000 * total / pl.col(count)))
            .otherwise(name)
            .alias(name)
            for name, count in PER_THOUSAND.items()
        ),
    )
    changed = scaled.select("timing", *_SECONDS, *PER_THOUSAND, "total_seconds").collect()
    return best.with_columns(changed.get_columns())


def _factors(measured: pl.LazyFrame) -> pl.LazyFrame:
    """Ratio of exclusive time to shared CPU time per stage; one row per machine and combination."""
    import polars as pl

    kept = measured.select(COLUMNS).sort("measured_at")
    alone = kept.filter(pl.col("timing") == "exclusive").unique("row_key", keep="last")
    beside = kept.filter(pl.col("timing").is_in(("shared", "estimated")))
    both = alone.join(
        beside.unique("row_key", keep="last"), on=("row_key", *_GROUP), suffix="_beside"
    )
    return both.group_by(_GROUP).agg(
        pl.lit(value=True).alias("_scaled"),
        *(
            _ratio(columns, ending).alias(f"_{stage}_{side}")
            for stage, columns in _STAGES.items()
            for side, ending in (("wall", ""), ("cpu", "_cpu"))
        ),
    )


def _ratio(columns: tuple[str, ...], ending: str) -> pl.Expr:
    """Sum of the exclusive times / sum of the shared CPU times; null if the latter is 0."""
    import polars as pl

    alone = pl.sum_horizontal(pl.col(f"{column}{ending}").sum() for column in columns)
    beside = pl.sum_horizontal(pl.col(f"{column}_cpu_beside").sum() for column in columns)
    return pl.when((beside > 0) & (alone > 0)).then(alone / beside)


def _total_seconds() -> pl.Expr:
    """`metrics.total_seconds` for whole columns."""
    import polars as pl

    stages = [
        sum((pl.col(column) for column in columns[1:]), pl.col(columns[0])) / len(columns)
        for columns in _STAGES.values()
    ]
    return sum(stages[1:], stages[0])
