"""The table of 3D reconstructions and their correlation with measured pairs, in the payload."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from aerocues.errors import ScoreError
from aerocues.results.combination_columns import COMBINATION, METHODS, combination_name
from aerocues.results.model_quality import best_first
from aerocues.results.reconstruction_schema import (
    BASELINE,
    RECONSTRUCTION_STATUSES,
    RECONSTRUCTIONS,
)
from aerocues.scoring.criteria import CRITERIA, Better
from aerocues.scoring.outcomes import FEWEST_MODELS, OUTCOMES, Relations, relations_of

if TYPE_CHECKING:
    import polars as pl

    from aerocues.results.schema import Column

OK = "ok"
REFERENCE = "reference"
UNIT_OF_MODEL = "model units"
# Without a true scale these are in the unit in the column `length_unit`.
DISTANCES = ("cloud_distance_", "reference_distance_")
# How models were made; shown once if all models share the value.
MADE = (
    *("preset", "pairing", "max_keypoints", "intrinsics", "mapper", "seed", "truth"),
    *("opencv_version", "colmap_version", "machine"),
)
BETTER: dict[str, Better] = {
    **{criterion.name: criterion.better for criterion in CRITERIA},
    **{outcome.name: outcome.better for outcome in OUTCOMES},
}
COSTS = re.compile(r"_distance_|_seconds$|_error$")


def model_facts(
    rows: pl.DataFrame, models: pl.DataFrame, *, chance_fails: bool
) -> dict[str, Any] | None:
    """Reconstructions of a dataset in the payload; None if there are none.

    Parameters
    ----------
    rows : pl.DataFrame
        Its measured pairs.
    models : pl.DataFrame
        Its reconstructions.
    chance_fails : bool
        Whether a pair that does not beat chance counts as failed.
    """
    import polars as pl

    if models.is_empty():
        return None
    name = combination_name()
    named = best_first(models).with_columns(name)
    alike = named.filter(pl.col(COMBINATION) != str(BASELINE))
    numbers = [
        column
        for column in RECONSTRUCTIONS
        if named[column.name].dtype.is_numeric()
        and column.name not in (*MADE, "reconstructed_at")
        and named[column.name].is_not_null().any()
    ]
    statuses = RECONSTRUCTION_STATUSES
    made = {each: _single(alike[each]) for each in MADE}
    return {
        "combinations": named[COMBINATION].to_list(),
        **{method: named[method].to_list() for method in METHODS},
        "status": named["status"].to_list(),
        "message": named["message"].to_list(),
        "columns": [_column(column, named) for column in numbers],
        "values": {column.name: named[column.name].to_list() for column in numbers},
        "reference": _single(named[REFERENCE]),
        "statuses": {status.name: status.meaning for status in statuses},
        "made": {each: value for each, value in made.items() if value is not None},
        "baseline": str(BASELINE) if len(alike) < len(named) else None,
        "relations": _relations(rows, models, chance_fails=chance_fails),
    }


def _column(column: Column, models: pl.DataFrame) -> dict[str, Any]:
    unit = column.unit
    if column.name.startswith(DISTANCES) and _single(models["length_unit"]) != "m":
        unit = UNIT_OF_MODEL
    return {
        "name": column.name,
        "unit": unit,
        "better": "lower" if COSTS.search(column.name) else BETTER.get(column.name),
        "definition": column.definition,
    }


def _single(values: pl.Series) -> Any:
    """The common value of all known ones; None if they differ."""
    known = values.drop_nulls().unique()
    return known[0] if len(known) == 1 else None


def _relations(rows: pl.DataFrame, models: pl.DataFrame, *, chance_fails: bool) -> dict[str, Any]:
    try:
        return _related(relations_of(rows, models, chance_fails=chance_fails))
    except ScoreError as error:
        return {"unavailable": str(error)}


def _related(found: Relations) -> dict[str, Any]:
    return {
        "combinations": found.combinations,
        "features": found.features,
        "outcomes": found.outcomes,
        "values": {
            **dict(zip(found.features, found.feature_values.T, strict=True)),
            **dict(zip(found.outcomes, found.outcome_values.T, strict=True)),
        },
        "pearson": found.pearson,
        "spearman": found.spearman,
        "numbers": found.numbers,
        "fewest": FEWEST_MODELS,
    }
