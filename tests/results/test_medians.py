"""Medians of each combination, on tables worked out by hand."""

from __future__ import annotations

from typing import Any

import polars as pl
import pytest

from aerocues.results.medians import combination_medians
from aerocues.results.schema import empty_row, polars_schema


def row(combination: str, pair: int, status: str = "ok", **values: Any) -> dict[str, Any]:
    methods = zip(
        ("detector", "descriptor", "norm", "matcher"), combination.split("-"), strict=True
    )
    images = {"dataset": "scene", "image_1": f"{pair}.png", "image_2": f"{pair + 1}.png"}
    return {**empty_row(), **dict(methods), **images, "pair": pair, "status": status, **values}


def table(*rows: dict[str, Any]) -> pl.DataFrame:
    return pl.DataFrame(rows, schema=polars_schema(), orient="row")


def counted(precision: float, matches: int, inliers: int) -> dict[str, Any]:
    return {"precision": precision, "matches": matches, "inliers": inliers}


def test_medians_count_pairs_without_success_as_zero() -> None:
    rows = table(
        row("ORB-ORB-HAM-BF", 0, **counted(0.9, 100, 90)),
        row("ORB-ORB-HAM-BF", 1, **counted(0.7, 200, 140)),
        row("ORB-ORB-HAM-BF", 2, "chance", **counted(0.5, 40, 20)),
        row("SIFT-SIFT-L2-BF", 0, **counted(0.8, 50, 40)),
        row("SIFT-SIFT-L2-BF", 1, **counted(0.8, 60, 48)),
        row("SIFT-SIFT-L2-BF", 2, **counted(0.6, 50, 30)),
        row("KAZE-KAZE-L2-BF", 0, **counted(1.0, 500, 500)),
        row("KAZE-KAZE-L2-BF", 1, "crashed"),
        row("KAZE-KAZE-L2-BF", 2, "timeout"),
    )
    best = combination_medians(rows)
    assert best["combination"].to_list() == ["SIFT-SIFT-L2-BF", "ORB-ORB-HAM-BF", "KAZE-KAZE-L2-BF"]
    assert best["precision"].to_list() == [0.8, 0.7, 0.0]
    assert best["matches"].to_list() == [50, 100, 0]
    assert best["inliers"].to_list() == [40, 90, 0]
    assert best["success_rate"].to_list() == pytest.approx([1, 2 / 3, 1 / 3])
    assert best["pairs"].to_list() == [3, 3, 3]


def test_pairs_are_counted_by_their_images() -> None:
    other = {"image_1": "a.png", "image_2": "b.png"}
    rows = table(
        row("ORB-ORB-HAM-BF", 0),
        row("ORB-ORB-HAM-BF", 0, **other),  # the first pair of another run
        row("ORB-ORB-HAM-BF", 7, **other),  # the same under another number
    )
    assert combination_medians(rows)["pairs"].to_list() == [2]


def test_times_are_medians_where_they_were_measured() -> None:
    def times(first: float, second: float, match: float) -> dict[str, Any]:
        return {
            "detect_seconds_1": first,
            "detect_seconds_2": second,
            "describe_seconds_1": 2 * first,
            "describe_seconds_2": 2 * second,
            "match_seconds": match,
            "verify_seconds": 0.5,
            "total_seconds": 1.5 * (first + second) + match + 0.5,
        }

    rows = table(
        row("ORB-ORB-HAM-BF", 0, **times(1, 3, 10)),
        row("ORB-ORB-HAM-BF", 1, **times(2, 6, 20)),
        row("ORB-ORB-HAM-BF", 2, "crashed"),
    )
    best = combination_medians(rows).row(0, named=True)
    assert best["detect_seconds"] == 3  # of 2 and 4
    assert best["describe_seconds"] == 6
    assert best["match_seconds"] == 15
    assert best["verify_seconds"] == 0.5
    assert best["total_seconds"] == 24.5  # of 16.5 and 32.5


def test_ties_are_broken_by_inliers_then_matches_then_name() -> None:
    rows = table(
        row("B-B-HAM-BF", 0, **counted(0.5, 10, 5)),
        row("A-A-HAM-BF", 0, **counted(0.5, 10, 5)),
        row("C-C-HAM-BF", 0, **counted(0.5, 20, 10)),
        row("D-D-HAM-BF", 0, **counted(0.5, 21, 10)),
    )
    names = combination_medians(rows)["combination"].to_list()
    assert [name[0] for name in names] == ["D", "C", "A", "B"]
    assert len(combination_medians(rows, top=2)) == 2


def test_an_empty_table_ranks_nothing() -> None:
    assert len(combination_medians(table())) == 0
