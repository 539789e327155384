"""Rows as `aerocues.Results` gives them, few and made up."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import polars as pl

METHODS = ("detector", "descriptor", "norm", "matcher")


def row(combination: str, pair: int, **values: Any) -> dict[str, Any]:
    """A row of status ok; what matters is given."""
    inliers, matches = values.get("inliers", 50), values.get("matches", 100)
    found: dict[str, Any] = {
        "dataset": "flight",
        "sequence": "one",
        "pair": pair,
        "image_1": f"{pair}.jpg",
        "image_2": f"{pair + 1}.jpg",
        **dict(zip(METHODS, combination.split("-"), strict=True)),
        "status": "ok",
        "machine": "desk",
        "keypoints_1": 400,
        "keypoints_2": 500,
        "matches": matches,
        "inliers": inliers,
        "chance_inliers": 10.0,
        "excess_inliers": float(inliers - 10),
        "precision": inliers / matches,
        "precision_beyond_chance": (inliers - 10) / matches,
        "recall": inliers / 400,
        "repeatability": inliers / 400,
        "f1_score": 0.2,
        "total_seconds": 1.0,
        "seconds_per_1k_matches": 10.0,
        "seconds_per_1k_inliers": 20.0,
        "detect_seconds_1": 0.1,
        "detect_seconds_2": 0.1,
        "describe_seconds_1": 0.2,
        "describe_seconds_2": 0.2,
        "match_seconds": 0.4,
        "verify_seconds": 0.1,
    }
    return found | values


def rows(*given: Mapping[str, Any]) -> pl.DataFrame:
    """A table of these rows."""
    return pl.DataFrame(list(given), infer_schema_length=None)


def models(values: Mapping[str, Sequence[float] | None]) -> pl.DataFrame:
    """Reconstructions: by combination reprojection error, points and seconds; None failed."""
    return pl.DataFrame(
        [
            {
                "dataset": "flight",
                **dict(zip(METHODS, combination.split("-"), strict=True)),
                "status": "ok" if found else "error",
                "reprojection_error": found[0] if found else None,
                "points_3d": found[1] if found else None,
                "reconstruction_seconds": found[2] if found else None,
            }
            for combination, found in values.items()
        ],
        schema_overrides={
            "reprojection_error": pl.Float64,
            "points_3d": pl.Float64,
            "reconstruction_seconds": pl.Float64,
        },
    )


class Stored:
    """Results that never were in a folder."""

    def __init__(self, table: pl.DataFrame, reconstructions: pl.DataFrame | None = None) -> None:
        self._table = table
        self._reconstructions = models({}) if reconstructions is None else reconstructions
        if not self._reconstructions.width or self._reconstructions.is_empty():
            self._reconstructions = models({"A-B-C-D": None}).clear()

    def table(self) -> pl.DataFrame:
        return self._table

    def reconstructions(self) -> pl.DataFrame:
        return self._reconstructions
