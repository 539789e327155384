"""The rows that a results folder is to hold: what each measured row is about.

A measurement is named by its content: a key of the images' pixels, the methods and the protocol.
What the images are called, and which number a pair has, may change; this table says it.
"""

from __future__ import annotations

from collections.abc import Container, Sequence
from typing import TYPE_CHECKING, NamedTuple

from aerocues.evaluation.schema import IDENTITY, polars_schema
from aerocues.evaluation.unit import Context
from aerocues.methods.combination import Combination

if TYPE_CHECKING:
    import polars as pl

PAIR = ("image_1", "image_2")
METHODS = ("detector", "descriptor", "norm", "matcher")
IDENTITY_NAMES = tuple(column.name for column in IDENTITY)
TIMED_ALONE = "timed_alone"


class PlannedRow(NamedTuple):
    """One row: the number of the pair, the combination and the key of the measurement."""

    pair: int
    combination: Combination
    row_key: str


def planned_table(
    context: Context,
    dataset_key: str,
    rows: Sequence[PlannedRow],
    timed: Container[int] = frozenset(),
) -> pl.DataFrame:
    """The planned rows of one run.

    Parameters
    ----------
    context : Context
    dataset_key : str
        How the images are read.
    rows : sequence of PlannedRow
    timed : container of int
        Pairs that are to be timed by themselves.

    Returns
    -------
    pl.DataFrame
        The columns that name a row (`schema.IDENTITY`), ``row_key``, ``settings_key``,
        ``dataset_key`` and ``timed_alone``, a boolean.
    """
    import polars as pl

    pairs = [context.dataset.pair(row.pair) for row in rows]
    columns: dict[str, list[str] | list[int]] = {
        "sequence": [pair.sequence for pair in pairs],
        "pair": [pair.index for pair in pairs],
        "image_1": [pair.image_1 for pair in pairs],
        "image_2": [pair.image_2 for pair in pairs],
        **{name: [getattr(row.combination, name) for row in rows] for name in METHODS},
        "row_key": [row.row_key for row in rows],
    }
    types = polars_schema()
    return pl.DataFrame(columns, schema={name: types[name] for name in columns}).with_columns(
        pl.lit(context.dataset.name).alias("dataset"),
        pl.lit(context.settings_key).alias("settings_key"),
        pl.lit(dataset_key).alias("dataset_key"),
        pl.Series(TIMED_ALONE, [pair.index in timed for pair in pairs], pl.Boolean),
    )


def with_all_columns(plan: pl.DataFrame) -> pl.DataFrame:
    """A plan as it is now; older ones do not say what is to be timed by itself."""
    import polars as pl

    if TIMED_ALONE in plan.columns:
        return plan
    return plan.with_columns(pl.lit(value=False).alias(TIMED_ALONE))


def merge_plans(old: pl.DataFrame, new: pl.DataFrame) -> pl.DataFrame:
    """Add a run's plan to what the folder holds.

    Rows of the same dataset stay where it is read in the same way under the same settings, so that
    a folder can be filled sequence by sequence or method by method; else the new ones replace them.
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
    return pl.concat([others.select(new.columns), renumbered, new])
