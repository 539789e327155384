from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from aerocues.results.metrics import METRICS, add_metrics
from aerocues.results.schema import COLUMNS, empty_row, polars_schema

COUNTED = {"keypoints_1": 800, "keypoints_2": 500, "matches": 200, "inliers": 120}
TIMED = {
    "detect_seconds_1": 0.10,
    "detect_seconds_2": 0.30,
    "describe_seconds_1": 0.04,
    "describe_seconds_2": 0.06,
    "match_seconds": 0.02,
    "verify_seconds": 0.03,
}


def measured(**values: Any) -> dict[str, Any]:
    return add_metrics({**empty_row(), **values})


def test_a_row_calculated_by_hand() -> None:
    right = {"ref_matching_score@1": 70 / 800, "ref_matching_score@3": 100 / 800}
    row = measured(**COUNTED, **TIMED, **right, chance_inliers=20.0)
    expected = {
        "precision": 0.6,
        "recall": 0.15,
        "repeatability": 0.24,
        "f1_score": 0.24,
        "excess_inliers": 100,
        "precision_beyond_chance": 0.5,
        "total_seconds": 0.30,
        "seconds_per_1k_matches": 1.5,
        "seconds_per_1k_inliers": 2.5,
        "seconds_per_1k_keypoints": 0.375,
        "ref_matches@1": 70,
        "ref_matches@3": 100,
        "seconds_per_1k_ref_matches": 3.0,
    }
    assert {metric.name for metric in METRICS} == set(expected)
    for name, value in expected.items():
        assert row[name] == pytest.approx(value), name


def test_repeatability_takes_the_smaller_count() -> None:
    row = measured(keypoints_1=50, keypoints_2=400, matches=40, inliers=25)
    assert row["repeatability"] == pytest.approx(0.5)


def test_fewer_inliers_than_chance_are_no_excess() -> None:
    row = measured(**{**COUNTED, "inliers": 10}, chance_inliers=14.2)
    assert row["excess_inliers"] == 0
    assert row["precision_beyond_chance"] == 0


def test_without_a_chance_test_there_is_no_excess() -> None:
    row = measured(**COUNTED)
    assert row["excess_inliers"] is None
    assert row["precision_beyond_chance"] is None


def test_zero_counts_leave_ratios_undefined_not_zero() -> None:
    row = measured(keypoints_1=0, keypoints_2=0, matches=0, inliers=0, **TIMED)
    for metric in METRICS:
        if metric.name not in ("total_seconds", "excess_inliers"):
            assert row[metric.name] is None, metric.name


def test_no_inliers_are_a_score_of_zero() -> None:
    row = measured(keypoints_1=10, keypoints_2=10, matches=9, inliers=0, **TIMED)
    assert (row["precision"], row["recall"], row["f1_score"]) == (0, 0, 0)
    assert row["seconds_per_1k_inliers"] is None
    assert row["seconds_per_1k_matches"] == pytest.approx(1000 * 0.30 / 9)


@pytest.mark.parametrize("missing", sorted(TIMED))
def test_a_stage_that_was_not_timed_leaves_the_total_undefined(missing: str) -> None:
    row = measured(**COUNTED, **{name: v for name, v in TIMED.items() if name != missing})
    assert row["total_seconds"] is None
    assert row["seconds_per_1k_matches"] is None
    assert row["precision"] == 0.6


def test_an_empty_row_has_every_column_and_no_metric() -> None:
    row = measured()
    assert list(row) == [column.name for column in COLUMNS] == list(polars_schema())
    assert set(row.values()) == {None}


@given(st.integers(1, 10**6), st.integers(1, 10**6), st.data())
def test_ratios_stay_in_bounds(keypoints_1: int, keypoints_2: int, data: st.DataObject) -> None:
    matches = data.draw(st.integers(0, min(keypoints_1, keypoints_2)))
    inliers = data.draw(st.integers(0, matches))
    row = measured(
        keypoints_1=keypoints_1, keypoints_2=keypoints_2, matches=matches, inliers=inliers
    )
    for name in ("precision", "recall", "repeatability", "f1_score"):
        assert row[name] is None or 0 <= row[name] <= 1
    if row["f1_score"]:
        harmonic = 2 / (1 / row["precision"] + 1 / row["recall"])
        assert row["f1_score"] == pytest.approx(harmonic)
