"""Metrics that are derived from the counts and times of a row: one row each."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

Row = dict[str, Any]
Better = Literal["higher", "lower"]
STAGES_OF_IMAGES = ("detect", "describe")
STAGES_OF_PAIRS = ("match", "verify")


@dataclass(frozen=True)
class Metric:
    """One derived metric; ``compute`` returns None if it is undefined."""

    name: str
    unit: str
    better: Better
    definition: str
    compute: Callable[[Mapping[str, Any]], float | None]


def _ratio(top: float | None, bottom: float | None) -> float | None:
    if top is None or not bottom:
        return None
    return top / bottom


def _excess(row: Mapping[str, Any]) -> float | None:
    if row["inliers"] is None or row["chance_inliers"] is None:
        return None
    return max(float(row["inliers"]) - float(row["chance_inliers"]), 0.0)


def _right_matches(threshold: int) -> Callable[[Mapping[str, Any]], float | None]:
    def compute(row: Mapping[str, Any]) -> float | None:
        score = row.get(f"ref_matching_score@{threshold}")
        return None if score is None else float(round(score * row["keypoints_1"]))

    return compute


def _repeatability(row: Mapping[str, Any]) -> float | None:
    counts = (row["keypoints_1"], row["keypoints_2"])
    return None if None in counts else _ratio(row["inliers"], min(counts))


def _f1_score(row: Mapping[str, Any]) -> float | None:
    precision = _ratio(row["inliers"], row["matches"])
    recall = _ratio(row["inliers"], row["keypoints_1"])
    if precision is None or recall is None:
        return None
    return 2 * precision * recall / (precision + recall) if precision + recall else 0.0


def total_seconds(row: Mapping[str, Any]) -> float | None:
    """Detect and describe one image (the mean of the two), match, verify."""
    total = 0.0
    for stage in STAGES_OF_IMAGES:
        both = (row[f"{stage}_seconds_1"], row[f"{stage}_seconds_2"])
        if None in both:
            return None
        total += sum(both) / 2
    for stage in STAGES_OF_PAIRS:
        seconds = row[f"{stage}_seconds"]
        if seconds is None:
            return None
        total += seconds
    return total


PER_THOUSAND: dict[str, str] = {
    "seconds_per_1k_matches": "matches",
    "seconds_per_1k_inliers": "inliers",
    "seconds_per_1k_keypoints": "keypoints_1",
    "seconds_per_1k_ref_matches": "ref_matches@3",
}
"""Metrics that divide `total_seconds` by a count of a row."""


def _per_thousand(name: str) -> Callable[[Mapping[str, Any]], float | None]:
    def compute(row: Mapping[str, Any]) -> float | None:
        total = total_seconds(row)
        return None if total is None else _ratio(1000 * total, row[PER_THOUSAND[name]])

    return compute


METRICS: tuple[Metric, ...] = (
    Metric(
        "precision",
        "ratio",
        "higher",
        "inliers / matches: the inlier ratio",
        lambda row: _ratio(row["inliers"], row["matches"]),
    ),
    Metric(
        "excess_inliers",
        "count",
        "higher",
        "max(inliers - chance_inliers, 0): inliers beyond chance",
        _excess,
    ),
    Metric(
        "precision_beyond_chance",
        "ratio",
        "higher",
        "excess_inliers / matches",
        lambda row: _ratio(_excess(row), row["matches"]),
    ),
    Metric(
        "recall",
        "ratio",
        "higher",
        "inliers / keypoints_1",
        lambda row: _ratio(row["inliers"], row["keypoints_1"]),
    ),
    Metric(
        "repeatability",
        "ratio",
        "higher",
        "inliers / min(keypoints_1, keypoints_2), as in the thesis; the true one is "
        "gt_repeatability",
        _repeatability,
    ),
    Metric("f1_score", "ratio", "higher", "harmonic mean of precision and recall", _f1_score),
    Metric(
        "total_seconds",
        "s",
        "lower",
        "detect and describe one image (mean of the two), match and verify",
        total_seconds,
    ),
    Metric(
        "seconds_per_1k_matches",
        "s",
        "lower",
        "1000 x total_seconds / matches; undefined without matches",
        _per_thousand("seconds_per_1k_matches"),
    ),
    Metric(
        "seconds_per_1k_inliers",
        "s",
        "lower",
        "1000 x total_seconds / inliers; undefined without inliers",
        _per_thousand("seconds_per_1k_inliers"),
    ),
    Metric(
        "seconds_per_1k_keypoints",
        "s",
        "lower",
        "1000 x total_seconds / keypoints_1; undefined without keypoints",
        _per_thousand("seconds_per_1k_keypoints"),
    ),
    *(
        Metric(
            f"ref_matches@{threshold}",
            "count",
            "higher",
            f"matches with an error against the reference up to {threshold} px",
            _right_matches(threshold),
        )
        for threshold in (1, 3)
    ),
    Metric(
        "seconds_per_1k_ref_matches",
        "s",
        "lower",
        "1000 x total_seconds / ref_matches@3; undefined without any",
        _per_thousand("seconds_per_1k_ref_matches"),
    ),
)


def add_metrics(row: Row) -> Row:
    """Fill in all metrics that follow from the values of the row, in the order of the table."""
    for metric in METRICS:
        row[metric.name] = metric.compute(row)
    return row
