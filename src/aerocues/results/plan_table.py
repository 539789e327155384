"""The table of planned rows of a results folder."""

from __future__ import annotations

from typing import TYPE_CHECKING

from aerocues.results.combination_columns import METHODS
from aerocues.results.schema import IDENTITY

if TYPE_CHECKING:
    import polars as pl

PAIR = ("image_1", "image_2")
IDENTITY_NAMES = tuple(column.name for column in IDENTITY)
TIMED_ALONE = "timed_alone"


def with_all_columns(plan: pl.DataFrame) -> pl.DataFrame:
    """A plan in the current format; older plans do not say which rows to time exclusively."""
    import polars as pl

    if TIMED_ALONE in plan.columns:
        return plan
    return plan.with_columns(pl.lit(value=False).alias(TIMED_ALONE))


def plan_of(rows: pl.DataFrame) -> pl.DataFrame:
    """A plan that holds the measured rows, each once; how their images were read is unknown."""
    import polars as pl

    keyed = rows.unique("row_key", keep="last", maintain_order=True)
    unknown = pl.lit(None, pl.String).alias("dataset_key")
    return with_all_columns(keyed.select(*IDENTITY_NAMES, "row_key", "settings_key", unknown))


def merge_plans(old: pl.DataFrame, new: pl.DataFrame) -> pl.DataFrame:
    """Add the plan of a run to the plan of the folder.

    Rows of the same dataset are kept if it is read in the same way under the same settings, so that
    a folder can be filled sequence by sequence or method by method. Otherwise the new rows replace
    them. A pair has the number that it has in the new plan; other pairs with such a number get a
    free one.
    """
    import polars as pl

    if not len(new):
        return old
    first = new.row(0, named=True)
    same = pl.col("dataset") == first["dataset"]
    continued = (pl.col("settings_key") == first["settings_key"]) & (
        pl.col("dataset_key") == first["dataset_key"]
    )
    others = old.filter(~same)
    kept = old.filter(same & continued).join(new, on=[*PAIR, *METHODS], how="anti")
    numbers = new.select(*PAIR, "pair", "sequence").unique(PAIR)
    renumbered = (
        kept.join(numbers, on=PAIR, how="left", suffix="_new")
        .with_columns(pl.coalesce(f"{name}_new", name).alias(name) for name in ("pair", "sequence"))
        .select(new.columns)
    )
    return pl.concat([others.select(new.columns), _with_free_numbers(renumbered, new), new])


def _with_free_numbers(kept: pl.DataFrame, new: pl.DataFrame) -> pl.DataFrame:
    """The kept rows; pairs that the new plan does not have do not share a number with its pairs."""
    import polars as pl

    others = kept.join(new, on=PAIR, how="anti").select(*PAIR, "pair").unique(PAIR)
    clashing = others.filter(pl.col("pair").is_in(new["pair"].implode())).sort("pair", *PAIR)
    if clashing.is_empty():
        return kept
    first = max(*kept["pair"], *new["pair"]) + 1
    free = pl.Series(range(first, first + len(clashing)), dtype=new.schema["pair"])
    numbers = clashing.with_columns(free.alias("free")).drop("pair")
    return (
        kept.join(numbers, on=PAIR, how="left", maintain_order="left")
        .with_columns(pl.coalesce("free", "pair").alias("pair"))
        .select(kept.columns)
    )
