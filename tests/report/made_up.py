"""Results folders of made-up measurements."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl

import aerocues
from tests.scoring.measurements import row

COMBINATIONS = (
    "ORB-ORB-HAM-BF",
    "ORB-BEBLID-HAM-FLANN",
    "AKAZE-AKAZE-HAM-BF",
    "SIFT-SIFT-L2-BF",
    "GFTT_H-DAISY-L2-FLANN",
)


def measured(
    *,
    dataset: str = "flight",
    machine: str = "desk",
    combinations: tuple[str, ...] = COMBINATIONS,
    pairs: int = 6,
    seed: int = 0,
    **fixed: Any,
) -> list[dict[str, Any]]:
    """Rows of every combination on every pair; the first combination is the best."""
    generator = np.random.default_rng(seed)
    rows = []
    for rank, name in enumerate(combinations):
        for pair in range(pairs):
            matches = int(generator.integers(200, 300))
            inliers = int(matches * (0.9 - 0.1 * rank) - generator.integers(0, 10))
            seconds = 0.1 * (rank + 1) + float(generator.random()) / 50
            values: dict[str, Any] = {
                "dataset": dataset,
                "machine": machine,
                "inliers": inliers,
                "matches": matches,
                "recall": inliers / 400,
                "repeatability": inliers / 400,
                "f1_score": 2 * inliers / (matches + 400),
                "total_seconds": seconds,
                "seconds_per_1k_matches": 1000 * seconds / matches,
                "seconds_per_1k_inliers": 1000 * seconds / inliers,
                "timing": "exclusive",
            }
            rows.append(row(name, pair, **(values | fixed)))
    return rows


def failed(one: Mapping[str, Any], status: str = "error", **changes: Any) -> dict[str, Any]:
    """The same row, failed, without what only a success has."""
    gone = ("inliers", "matches", "precision", "recall", "repeatability", "f1_score")
    more = ("excess_inliers", "precision_beyond_chance", "chance_inliers")
    times = ("seconds_per_1k_matches", "seconds_per_1k_inliers", "total_seconds", "match_seconds")
    nothing = dict.fromkeys((*gone, *more, *times, "verify_seconds"))
    return {**one, **nothing, "status": status, "message": "it went wrong", **changes}


def folder_of(rows: list[dict[str, Any]], folder: Path) -> aerocues.Results:
    """A results folder with these rows."""
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / "rows.parquet"
    pl.DataFrame(rows, infer_schema_length=None).write_parquet(file)
    [results] = aerocues.import_results(file, folder / "results")
    return results
