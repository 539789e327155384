"""The published measurements as decision tables."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest

from aerocues.scoring import SCORE_PRESETS, DecisionTable, criteria_named

PublishedTable = Callable[..., DecisionTable]


@pytest.fixture(scope="session")
def published(shared_data: Path) -> PublishedTable:
    """Gives the table of a published data set: ``published(dataset, platform="desktop")``."""
    import polars as pl

    file = shared_data / "published" / "measurements.parquet"
    measurements = pl.read_parquet(file).with_columns(
        pl.concat_str("detector", "descriptor", "norm", "matcher", separator="-").alias("name")
    )

    @cache
    def table(dataset: str, platform: str = "desktop") -> DecisionTable:
        chosen = measurements.filter(
            pl.col("dataset").cast(pl.String) == dataset,
            pl.col("platform").cast(pl.String) == platform,
        )
        return DecisionTable.from_frame(
            chosen,
            alternative="name",
            repeat="pair",
            criteria=criteria_named(SCORE_PRESETS["thesis"].criteria),
        )

    return table
