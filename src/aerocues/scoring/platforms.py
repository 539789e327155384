"""Compares times of the same dataset on two machines."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import polars as pl

from aerocues.errors import ScoreError
from aerocues.results.combination_columns import METHODS

KEY = (*METHODS, "pair", "image_1", "image_2")
MEASURED = ("ok", "chance")


@dataclass(frozen=True)
class Stage:
    """A stage, the columns whose sum is its time, and the methods that the time depends on."""

    name: str
    columns: tuple[str, ...]
    methods: tuple[str, ...] = ()


STAGES: tuple[Stage, ...] = (
    Stage("detect", ("detect_seconds_1", "detect_seconds_2"), ("detector",)),
    Stage("describe", ("describe_seconds_1", "describe_seconds_2"), ("descriptor",)),
    Stage("match", ("match_seconds",), ("norm", "matcher")),
    Stage("verify", ("verify_seconds",)),
    Stage("total", ("total_seconds",)),
)


def compare_times(first: pl.DataFrame, second: pl.DataFrame) -> pl.DataFrame:
    """Compare the times of the same combinations on the same pairs.

    Quality should not depend on the machine. Times do, and some stages more than others.

    Parameters
    ----------
    first, second : pl.DataFrame
        Rows of one dataset, measured on two machines.

    Returns
    -------
    pl.DataFrame
        One row per stage measured on both: ``stage``; ``rows`` (measured on both);
        ``first_seconds, second_seconds`` (medians); ``ratio`` of second to first (geometric mean
        over the rows) with ``ratio_low, ratio_high`` (5th and 95th percentile of the rows); and
        ``rank_correlation`` (Spearman, of the combinations' mean times).

    Raises
    ------
    ScoreError
        If no stage was measured for the same rows on both machines.
    """
    joined = _of_success(first).join(_of_success(second), on=KEY, suffix="_of_second")
    stages = [row for stage in STAGES if (row := _compare_stage(joined, stage)) is not None]
    if not stages:
        raise ScoreError(
            "the two results share no row with times; measure the same dataset with the same "
            "combinations on both machines"
        )
    return pl.DataFrame(stages)


def _of_success(rows: pl.DataFrame) -> pl.DataFrame:
    columns = {column for stage in STAGES for column in stage.columns} & set(rows.columns)
    return rows.filter(pl.col("status").is_in(MEASURED)).select(*KEY, *sorted(columns))


def _compare_stage(joined: pl.DataFrame, stage: Stage) -> dict[str, object] | None:
    from aerocues.scoring.correlation import rank_correlation

    of_second = tuple(f"{name}_of_second" for name in stage.columns)
    if not {*stage.columns, *of_second} <= set(joined.columns):
        return None
    times = joined.select(
        *METHODS,
        pl.sum_horizontal(pl.col(stage.columns), ignore_nulls=False).alias("first"),
        pl.sum_horizontal(pl.col(of_second), ignore_nulls=False).alias("second"),
    ).filter(pl.col("first") > 0, pl.col("second") > 0)
    if times.is_empty():
        return None
    ratio = (times["second"] / times["first"]).to_numpy()
    means = times.group_by(METHODS).agg(pl.col("first", "second").mean())
    correlation = rank_correlation(means.select("first", "second").to_numpy().T)[0, 1]
    low, high = np.quantile(ratio, [0.05, 0.95])
    return {
        "stage": stage.name,
        "rows": len(times),
        "first_seconds": times["first"].median(),
        "second_seconds": times["second"].median(),
        "ratio": float(np.exp(np.log(ratio).mean())),
        "ratio_low": float(low),
        "ratio_high": float(high),
        "rank_correlation": None if np.isnan(correlation) else float(correlation),
    }


def device_factors(first: pl.DataFrame, second: pl.DataFrame) -> dict[str, dict[str, float]]:
    """Time ratio of the second machine to the first, for each stage and method.

    Parameters
    ----------
    first, second : pl.DataFrame
        Rows of one dataset, measured on two machines, with the times of stages.

    Returns
    -------
    dict
        By stage (``detect, describe, match, verify``), then by detector, descriptor, or norm and
        matcher (``L2-BF``); ``*`` stands for all. Geometric means over the same rows.

    Raises
    ------
    ScoreError
        If a stage was not measured for the same rows on both machines.
    """
    joined = _of_success(first).join(_of_success(second), on=KEY, suffix="_of_second")
    factors: dict[str, dict[str, float]] = {}
    for stage in STAGES[:-1]:
        columns = [*stage.columns, *(f"{name}_of_second" for name in stage.columns)]
        if joined.is_empty() or not set(columns) <= set(joined.columns):
            raise _lacks_times(stage)
        here = pl.sum_horizontal(pl.col(stage.columns), ignore_nulls=False)
        there = pl.sum_horizontal(
            pl.col(f"{name}_of_second" for name in stage.columns), ignore_nulls=False
        )
        method = pl.concat_str(stage.methods, separator="-") if stage.methods else pl.lit("*")
        ratios = joined.select(method.alias("method"), (there / here).log().alias("ratio")).filter(
            pl.col("ratio").is_finite()
        )
        if ratios.is_empty():  # as in tables of totals alone
            raise _lacks_times(stage)
        by_method = ratios.group_by("method").agg(pl.col("ratio").mean().exp()).sort("method")
        whole = float(np.exp(ratios["ratio"].to_numpy().mean()))
        factors[stage.name] = {"*": whole, **dict(by_method.iter_rows())}
    return factors


def _lacks_times(stage: Stage) -> ScoreError:
    return ScoreError(
        f"the two results share no row with times of the stage {stage.name}; measure the same "
        "dataset with the same combinations on both machines"
    )
