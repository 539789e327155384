"""The planned rows of a results folder, which give measurements their names.

The key of a measurement depends on the pixels, the methods and the protocol. Names of images and
numbers of pairs can change; they are stored in this table.
"""

from __future__ import annotations

from collections.abc import Container, Sequence
from typing import TYPE_CHECKING, NamedTuple

from aerocues.evaluation.unit import Context
from aerocues.methods.combination import Combination
from aerocues.results.combination_columns import METHODS
from aerocues.results.plan_table import TIMED_ALONE
from aerocues.results.schema import polars_schema

if TYPE_CHECKING:
    import polars as pl


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
        Hash of how the images are read.
    rows : sequence of PlannedRow
    timed : container of int
        Pairs with exclusive timing.

    Returns
    -------
    pl.DataFrame
        The columns that identify a row (`schema.IDENTITY`), ``row_key``, ``settings_key``,
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
