"""Times of the same work on two machines."""

from __future__ import annotations

import polars as pl
import pytest

from aerocues.errors import ScoreError
from aerocues.scoring.platforms import STAGES, compare_times
from tests.scoring.measurements import row, rows

NAMES = ("ORB-ORB-HAM-BF", "SIFT-SIFT-L2-BF", "KAZE-KAZE-L2-BF")


def measured(*match_seconds: float, **changes: object) -> pl.DataFrame:
    return rows(
        *(
            row(name, 0, match_seconds=seconds, **changes)
            for name, seconds in zip(NAMES, match_seconds, strict=True)
        )
    )


def stage(times: pl.DataFrame, name: str) -> dict[str, object]:
    return times.filter(pl.col("stage") == name).row(0, named=True)


def test_the_ratio_is_a_geometric_mean_and_ranks_are_of_combinations() -> None:
    times = compare_times(measured(1.0, 2.0, 4.0), measured(2.0, 8.0, 4.0))
    match = stage(times, "match")
    assert match["ratio"] == pytest.approx((2 * 4 * 1) ** (1 / 3))
    assert (match["first_seconds"], match["second_seconds"]) == (2, 4)
    assert match["rank_correlation"] == pytest.approx(0.5)
    assert match["rows"] == 3
    assert times["stage"].to_list() == [each.name for each in STAGES]


def test_times_of_both_images_are_summed() -> None:
    first = measured(1, 1, 1, detect_seconds_1=0.1, detect_seconds_2=0.3)
    second = measured(1, 1, 1, detect_seconds_1=0.5, detect_seconds_2=0.3)
    assert stage(compare_times(first, second), "detect")["ratio"] == pytest.approx(2)


def test_only_rows_that_both_measured_count() -> None:
    second = measured(2.0, 2.0, 2.0).with_columns(status=pl.Series(["ok", "timeout", "chance"]))
    assert stage(compare_times(measured(1, 1, 1), second), "match")["rows"] == 2


def test_imported_rows_without_stages_are_compared_by_their_total() -> None:
    stages = [name for each in STAGES[:-1] for name in each.columns]
    first = measured(1, 1, 1).drop(stages)
    second = measured(1, 1, 1, total_seconds=3.0).with_columns(
        pl.lit(None, pl.Float64).alias(name) for name in stages
    )
    times = compare_times(first, second)
    assert times["stage"].to_list() == ["total"]
    assert times["ratio"].to_list() == pytest.approx([3])


def test_pairs_of_the_same_number_but_other_images_are_not_compared() -> None:
    other = measured(1, 1, 1).with_columns(image_2=pl.lit("9.jpg"))
    with pytest.raises(ScoreError, match="share no row with times"):
        compare_times(measured(1, 1, 1), other)


def test_nothing_in_common_is_told() -> None:
    other = measured(1, 1, 1).with_columns(pair=pl.lit(7, pl.Int64))
    with pytest.raises(ScoreError, match="share no row with times"):
        compare_times(measured(1, 1, 1), other)
