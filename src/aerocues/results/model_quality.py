"""Which of several models of a scene is the best."""

from __future__ import annotations

from collections.abc import Mapping
from math import sqrt
from typing import TYPE_CHECKING, Any

from aerocues.results.combination_columns import name_in_row

if TYPE_CHECKING:
    import polars as pl

MODEL_QUALITY = "model_quality"
POSES = "poses"


def model_quality(row: Mapping[str, Any]) -> float | None:
    """Share of the images in place x sqrt(points that check each other / error).

    Points that two images see are always near their rays: points in 3 images or more count. The
    error is that of the surface or of the cameras where these are known exactly, in metres; else
    the reprojection error, in pixels. Models of one scene compare, of several do not.

    Parameters
    ----------
    row : mapping
        Of the table of reconstructions.

    Returns
    -------
    float or None
        None where there is no model, or its figures were not measured.
    """
    placed = row.get("placed_images")
    placed = row.get("registered_images") if placed is None else placed
    images, points, error = row.get("images"), row.get("points_in_3_images"), _error(row)
    if placed is None or points is None or not images or not error:
        return None
    return float(placed / images * sqrt(points / error))


def _error(row: Mapping[str, Any]) -> float | None:
    names = ["reprojection_error"]
    if row.get("truth") == POSES:
        names = ["surface_error", "position_rmse", *names]
    return next((row[name] for name in names if row.get(name) is not None), None)


def model_order(row: Mapping[str, Any]) -> tuple[bool, float, int, int]:
    """Sorts the best first: by success, then quality; where that is not known, by size.

    Never by the reprojection error alone: broken models have the lowest.
    """
    return (
        row["status"] != "ok",
        -(model_quality(row) or 0.0),
        -(row.get("registered_images") or 0),
        -(row.get("points_3d") or 0),
    )


def best_first(table: pl.DataFrame) -> pl.DataFrame:
    """The rows of reconstructions from the best to the worst."""
    rows = table.to_dicts()
    order = sorted(
        range(len(rows)), key=lambda number: (model_order(rows[number]), name_in_row(rows[number]))
    )
    return table[order]
