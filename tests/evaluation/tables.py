"""A small table of measurements as others make them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import polars as pl

COMBINATIONS = ("orb-orb-ham-bf", "Sift-Sift-L2-Flann")
METHODS = ("detector", "descriptor", "norm", "matcher")


def measured(dataset: str, platform: str | None, pairs: int = 2) -> list[dict[str, Any]]:
    """Rows of two combinations on some pairs; the last pair of the last one failed."""
    rows = [
        {
            "dataset": dataset,
            "platform": platform,
            **dict(zip(METHODS, combination.split("-"), strict=True)),
            "pair": pair,
            "precision": 0.5,
            "recall": 0.25,
            "repeatability": 0.3,
            "f1_score": 1 / 3,
            "inliers": 100 + pair,
            "matches": 200 + 2 * pair,
            "seconds_per_1k_matches": 0.5,
            "seconds_per_1k_inliers": 1.0,
        }
        for combination in COMBINATIONS
        for pair in range(pairs)
    ]
    rows[-1] |= dict.fromkeys(list(rows[-1])[7:], None)
    return rows


def write_table(file: Path, rows: list[dict[str, Any]]) -> Path:
    frame = pl.DataFrame(rows)
    if file.suffix == ".csv":
        frame.write_csv(file)
    else:
        frame.write_parquet(file)
    return file


def figures(dataset: str) -> list[dict[str, Any]]:
    """Figures of reconstructions with the two combinations; the last one failed."""
    rows = [
        {
            "dataset": dataset,
            **dict(zip(METHODS, combination.split("-"), strict=True)),
            "reprojection_error_px": 0.5,
            "points_3d": 800.0,
            "reconstruction_seconds": 12.5,
        }
        for combination in COMBINATIONS
    ]
    rows[-1] |= dict.fromkeys(list(rows[-1])[5:], None)
    return rows
