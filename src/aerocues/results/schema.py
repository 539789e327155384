"""The columns of a results table: one row each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

from aerocues.results.metrics import METRICS, Row

ColumnType = Literal["string", "integer", "float"]
PIXEL_THRESHOLDS = (1, 3, 5)
ANGLE_THRESHOLDS = (5, 10, 20)


@dataclass(frozen=True)
class Column:
    """One column: its name, type, unit and definition."""

    name: str
    type: ColumnType
    unit: str
    definition: str


def _text(name: str, definition: str) -> Column:
    return Column(name, "string", "", definition)


def _count(name: str, definition: str) -> Column:
    return Column(name, "integer", "count", definition)


def _seconds(name: str, what: str) -> tuple[Column, Column]:
    return (
        Column(name, "float", "s", f"wall seconds to {what}"),
        Column(f"{name}_cpu", "float", "s", f"CPU seconds to {what}"),
    )


IDENTITY: tuple[Column, ...] = (
    _text("dataset", "name of the dataset"),
    _text("sequence", "scene, sequence, project or kind of transformation"),
    Column("pair", "integer", "", "0-based position of the pair in the dataset"),
    _text("image_1", "first image"),
    _text("image_2", "second image"),
    _text("detector", "detector"),
    _text("descriptor", "descriptor"),
    _text("norm", "norm under which descriptors are compared"),
    _text("matcher", "matcher"),
)

OUTCOME: tuple[Column, ...] = (
    _text("status", "how the evaluation ended"),
    _text("message", "the message of an error, or what is unusual"),
)

COUNTS: tuple[Column, ...] = (
    _count(
        "keypoints_1",
        "keypoints of image 1 with a descriptor; if there are none, the detected keypoints",
    ),
    _count(
        "keypoints_2",
        "keypoints of image 2 with a descriptor; if there are none, the detected keypoints",
    ),
    _count("matches", "mutual matches"),
    _count("inliers", "matches that agree with the model: the fundamental matrix, see sampling"),
    Column("chance_inliers", "float", "count", "mean inliers over the shuffled matches"),
    _count("chance_inliers_max", "largest number of inliers over the shuffled matches"),
    _text(
        "sampling",
        "how the model was found: uniform; guided (by distance) if uniform found none better than "
        "chance; homography if only that did (homography data; its inliers are then counted)",
    ),
    _count("homography_inliers", "matches that agree with the homography (homography data)"),
)

TIMES: tuple[Column, ...] = (
    *_seconds("detect_seconds_1", "detect in image 1"),
    *_seconds("detect_seconds_2", "detect in image 2"),
    *_seconds("describe_seconds_1", "describe image 1"),
    *_seconds("describe_seconds_2", "describe image 2"),
    *_seconds("match_seconds", "match in both directions, including building indices"),
    *_seconds("verify_seconds", "estimate the fundamental matrix"),
)

HOW_TIMED: tuple[Column, ...] = (
    _count(
        "timing_repeats", "smallest number of calls behind the median of a stage (exclusive timing)"
    ),
    Column(
        "timing_spread",
        "float",
        "ratio",
        "largest (slowest - fastest) / median of the calls of a stage, for stages of a millisecond "
        "or more (exclusive timing)",
    ),
    Column(
        "wall_over_cpu",
        "float",
        "ratio",
        "largest wall / CPU seconds of a stage of a millisecond or more; above 1.1 it shared "
        "its core in every attempt (exclusive timing)",
    ),
)

RESOURCES: tuple[Column, ...] = (
    Column("descriptor_bytes", "integer", "B", "bytes of one descriptor"),
    Column(
        "peak_memory_mb",
        "float",
        "MB",
        "largest increase of the resident set in one stage call (exclusive timing on Linux)",
    ),
)


def _right_points(prefix: str, error: str) -> tuple[Column, ...]:
    """What is told of matches and keypoints by their errors."""
    return (
        *(
            Column(
                f"{prefix}_precision@{t}",
                "float",
                "ratio",
                f"share of matches with {error} up to {t} px",
            )
            for t in PIXEL_THRESHOLDS
        ),
        *(
            Column(
                f"{prefix}_matching_score@{t}",
                "float",
                "ratio",
                f"matches with {error} up to {t} px / keypoints_1",
            )
            for t in PIXEL_THRESHOLDS
        ),
        Column(
            f"{prefix}_repeatability",
            "float",
            "ratio",
            "share of covisible keypoints found again within 3 px, one to one",
        ),
    )


REFERENCE: tuple[Column, ...] = (
    _text("reference", "flow, or the reason why the two images have no reference"),
    Column(
        "reference_agreement",
        "float",
        "ratio",
        "share of the matches behind the reference within 3 px of it; trusted from 0.5 on",
    ),
    Column(
        "reference_turn",
        "float",
        "degrees",
        "by how much image 2 is turned against image 1 at its centre, 0 to 180",
    ),
    *_right_points("ref", "an error against the reference"),
    Column(
        "coverage",
        "float",
        "ratio",
        "share of the cells of a 16 x 16 grid on image 1 that hold a match within 3 px of the "
        "reference",
    ),
)

GROUND_TRUTH: tuple[Column, ...] = (
    *_right_points("gt", "a true error"),
    Column(
        "homography_error",
        "float",
        "px",
        "mean corner error of the estimated homography; infinite if there is none",
    ),
    *(
        Column(
            f"homography_auc@{t}",
            "float",
            "ratio",
            f"area under the cumulative curve of homography_error up to {t} px",
        )
        for t in PIXEL_THRESHOLDS
    ),
    Column(
        "pose_error",
        "float",
        "degrees",
        "the larger of the angle errors of rotation and of the direction of translation; "
        "infinite if there is no estimate",
    ),
    *(
        Column(
            f"pose_auc@{a}",
            "float",
            "ratio",
            f"area under the cumulative curve of pose_error up to {a} degrees",
        )
        for a in ANGLE_THRESHOLDS
    ),
)

PROVENANCE: tuple[Column, ...] = (
    _text("preset", "preset of parameters and protocol"),
    *(
        Column(
            f"turned_{side}",
            "integer",
            "degrees",
            f"counterclockwise turn of image {side} while features were found, where asked for",
        )
        for side in (1, 2)
    ),
    _text("parameters", "parameters of detector, descriptor and matcher, as JSON"),
    _count("max_keypoints", "maximum number of keypoints per image; 0: all"),
    _text("keypoint_choice", "which keypoints were kept: strongest, or spread over the image"),
    Column("inlier_threshold", "float", "px", "inlier threshold of the verification"),
    _text("opencv_version", "version of OpenCV"),
    _text("machine", "processor of the machine"),
    Column("seed", "integer", "", "seed set before every stage call"),
    _text(
        "timing",
        "exclusive: on a core of its own; scaled: shared times, multiplied by the exclusive / "
        "shared "
        "ratio of the combination; shared: beside other workers; estimated: "
        "shared, with brute force timed on a sample of the descriptors",
    ),
    Column("measured_at", "float", "s", "when the row was measured, in seconds since 1970 (UTC)"),
    _text("settings_key", "hash of preset, protocol and versions: equal within one table"),
    _text("row_key", "hash of everything that the row depends on"),
)

DERIVED: tuple[Column, ...] = tuple(
    Column(metric.name, "float", metric.unit, metric.definition) for metric in METRICS
)

COLUMNS: tuple[Column, ...] = (
    *IDENTITY,
    *OUTCOME,
    *COUNTS,
    *DERIVED,
    *REFERENCE,
    *GROUND_TRUTH,
    *TIMES,
    *HOW_TIMED,
    *RESOURCES,
    *PROVENANCE,
)


def empty_row() -> Row:
    """A row with all columns, in which every value is unknown."""
    return {column.name: None for column in COLUMNS}


def polars_schema(columns: Sequence[Column] = COLUMNS) -> dict[str, Any]:
    """Columns with their polars types."""
    import polars as pl

    types = {"string": pl.String, "integer": pl.Int64, "float": pl.Float64}
    return {column.name: types[column.type]() for column in columns}
