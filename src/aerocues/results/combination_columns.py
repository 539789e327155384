"""The columns that name a combination in tables."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import polars as pl

METHODS = ("detector", "descriptor", "norm", "matcher")
COMBINATION = "combination"


def combination_name() -> pl.Expr:
    """The text form of the combination, such as ``ORB-BEBLID-HAM-BF``, as column `COMBINATION`."""
    import polars as pl

    return pl.concat_str(METHODS, separator="-").alias(COMBINATION)


def name_in_row(row: Mapping[str, Any]) -> str:
    """The text form of the combination in a row."""
    return "-".join(str(row[method]) for method in METHODS)
