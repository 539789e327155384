"""What a combination may cost at most: limits that users have, a row each."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from aerocues.errors import ScoreError
from aerocues.results.combination_columns import COMBINATION, combination_name

if TYPE_CHECKING:
    import polars as pl


@dataclass(frozen=True)
class Limit:
    """One kind of limit.

    Attributes
    ----------
    name : str
    column : str
        Column of the measured rows (see `results.metrics`), and of the costs.
    statistic : {"median", "max"}
        Of a combination's rows.
    unit : str
    told : str
        What it is, in words.
    remedy : str
        What to do where it was not measured.
    """

    name: str
    column: str
    statistic: str
    unit: str
    told: str
    remedy: str


LIMITS: tuple[Limit, ...] = (
    Limit(
        "max_seconds_per_image",
        "total_seconds",
        "median",
        "s",
        "time for one image and one pair",
        "measure with times",
    ),
    Limit(
        "max_memory",
        "peak_memory_mb",
        "max",
        "MB",
        "increase of memory in one stage",
        "measure with exclusive times",
    ),
    Limit(
        "max_descriptor_bytes",
        "descriptor_bytes",
        "max",
        "bytes",
        "size of a descriptor",
        "measure with `aerocues.run`",
    ),
)


def costs_of(rows: pl.DataFrame) -> pl.DataFrame:
    """What each combination costs.

    Returns
    -------
    pl.DataFrame
        ``combination`` and a column for each row of `LIMITS`, null where it was not measured.
    """
    import polars as pl

    statistics = {"median": pl.Expr.median, "max": pl.Expr.max}
    return (
        rows.group_by(combination_name())
        .agg(
            statistics[limit.statistic](pl.col(limit.column).cast(pl.Float64)).alias(limit.column)
            if limit.column in rows.columns
            else pl.lit(None, pl.Float64).alias(limit.column)
            for limit in LIMITS
        )
        .sort(COMBINATION)
    )


def exceeded(costs: pl.DataFrame, most: Mapping[str, float]) -> dict[str, str]:
    """Why combinations are left out, by their names.

    Parameters
    ----------
    costs : pl.DataFrame
        See `costs_of`.
    most : mapping of str to float
        Largest allowed values, by names of `LIMITS`.

    Raises
    ------
    ScoreError
        If what is limited was not measured for any combination.
    """
    reasons: dict[str, str] = {}
    for limit in LIMITS:
        if limit.name not in most:
            continue
        known = dict(costs.select(COMBINATION, limit.column).iter_rows())
        if all(value is None for value in known.values()):
            raise ScoreError(
                f"the {limit.told} was not measured, so it cannot be limited; {limit.remedy}, or "
                f"leave out `{limit.name}`"
            )
        for name, value in known.items():
            if value is None:
                reasons.setdefault(name, f"{limit.told} not measured")
            elif value > most[limit.name]:
                reasons.setdefault(name, f"{limit.told}: {value:.3g} {limit.unit}")
    return reasons
