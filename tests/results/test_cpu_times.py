"""CPU times in place of wall times."""

from __future__ import annotations

import polars as pl
import pytest

from aerocues.results.cpu_times import with_cpu_times
from aerocues.results.schema import empty_row, polars_schema

STAGES = ("detect_seconds_1", "detect_seconds_2", "describe_seconds_1", "describe_seconds_2")


def rows(**figures: float | None) -> pl.DataFrame:
    return pl.DataFrame([{**empty_row(), **figures}], schema=polars_schema())


def test_each_stage_takes_its_cpu_time_and_metrics_follow() -> None:
    """By hand: (1 + 3) / 2 + (0.5 + 0.5) / 2 + 2 + 0.1 = 4.6 s; 23 matches are 200 s a thousand."""
    cpu = dict(zip(STAGES, (1.0, 3.0, 0.5, 0.5), strict=True))
    cpu |= {"match_seconds": 2.0, "verify_seconds": 0.1}
    wall = {name: 2 * value for name, value in cpu.items()}
    both = wall | {f"{name}_cpu": value for name, value in cpu.items()}
    told = {"matches": 23, "wall_over_cpu": 2.0, "timing_spread": 0.5, "total_seconds": 9.2}
    row = with_cpu_times(rows(**both, **told)).row(0, named=True)
    assert {name: row[name] for name in cpu} == cpu
    assert row["total_seconds"] == pytest.approx(4.6)
    assert row["seconds_per_1k_matches"] == pytest.approx(200)
    assert row["wall_over_cpu"] is None
    assert row["timing_spread"] is None


def test_times_without_cpu_times_stay() -> None:
    row = with_cpu_times(rows(match_seconds=2.0, total_seconds=5.0)).row(0, named=True)
    assert (row["match_seconds"], row["total_seconds"]) == (2.0, 5.0)
    assert row["seconds_per_1k_matches"] is None


def test_it_changes_nothing_the_second_time() -> None:
    cpu = {f"{name}_cpu": 1.0 for name in (*STAGES, "match_seconds", "verify_seconds")}
    once = with_cpu_times(rows(matches=10, **cpu))
    assert once["total_seconds"].to_list() == [4.0]
    assert with_cpu_times(once).equals(once)
