"""The quantities per pair that the report shows: one row each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from aerocues.report.arrays import packed_floats
from aerocues.results.combination_columns import combination_name
from aerocues.scoring.criteria import CRITERIA, Criterion

if TYPE_CHECKING:
    import polars as pl

Better = Literal["higher", "lower"]


@dataclass(frozen=True)
class PairColumn:
    """One quantity.

    Attributes
    ----------
    name, unit : str
    better : {"higher", "lower"} or None
    definition : str
    source : str
        A column of the measurements, or an SQL expression of columns; the name by default.
    of_success : bool
        Whether it is shown for successful pairs only; values of failed pairs would mislead.
    """

    name: str
    unit: str
    better: Better | None
    definition: str
    source: str = ""
    of_success: bool = True


def _of_two_images(stage: str, what: str) -> PairColumn:
    both = f"({stage}_seconds_1 + {stage}_seconds_2) / 2"
    definition = f"wall seconds to {what} one image, the mean of the two"
    return PairColumn(f"{stage}_seconds", "s", "lower", definition, both, of_success=False)


def _true(name: str, unit: str, definition: str) -> PairColumn:
    return PairColumn(name, unit, "higher", definition, of_success=False)


SHOWN: tuple[PairColumn, ...] = (
    PairColumn("precision", "ratio", "higher", "inliers / matches: the inlier ratio"),
    PairColumn("recall", "ratio", "higher", "inliers / keypoints of image 1"),
    PairColumn("repeatability", "ratio", "higher", "inliers / the smaller number of keypoints"),
    PairColumn("f1_score", "ratio", "higher", "harmonic mean of precision and recall"),
    PairColumn("inliers", "count", "higher", "matches that agree with the model"),
    PairColumn("matches", "count", "higher", "mutual matches"),
    PairColumn("keypoints_1", "count", None, "keypoints of image 1", of_success=False),
    PairColumn(
        "total_seconds",
        "s",
        "lower",
        "seconds for one image (detect, describe) and one pair (match, verify)",
        of_success=False,
    ),
    PairColumn("seconds_per_1k_matches", "s", "lower", "seconds for 1000 matches"),
    PairColumn("seconds_per_1k_inliers", "s", "lower", "seconds for 1000 inliers"),
    _of_two_images("detect", "detect in"),
    _of_two_images("describe", "describe"),
    PairColumn("match_seconds", "s", "lower", "wall seconds to match", of_success=False),
    PairColumn("verify_seconds", "s", "lower", "wall seconds to verify", of_success=False),
    _true("gt_precision@3", "ratio", "share of matches correct within 3 px, by the ground truth"),
    _true("gt_matching_score@3", "ratio", "matches correct within 3 px / keypoints of image 1"),
    _true("gt_repeatability", "ratio", "covisible keypoints found again within 3 px"),
    _true("homography_auc@3", "ratio", "accuracy of the estimated homography up to 3 px"),
    _true("pose_auc@10", "ratio", "accuracy of the estimated relative pose up to 10 degrees"),
)


def _unit(criterion: Criterion) -> str:
    name = criterion.name
    if "seconds" in name:
        return "s"
    units = {"descriptor_bytes": "B", "peak_memory_mb": "MB", "excess_inliers": "count"}
    return units.get(name, "ratio")


def columns_for(criteria: Sequence[Criterion]) -> list[PairColumn]:
    """The quantities to show with these criteria: the criteria first, each once."""
    shown = {column.name: column for column in SHOWN}
    first = {
        each.name: shown.get(each.name)
        or PairColumn(each.name, _unit(each), each.better, each.description, each.source)
        for each in criteria
        if not each.reconstruction
    }
    return list({**first, **shown}.values())


def column_facts(
    rows: pl.DataFrame,
    positions: tuple[NDArray[np.int64], NDArray[np.int64]],
    shape: tuple[int, int],
    succeeded: Sequence[str],
    criteria: Sequence[Criterion],
) -> dict[str, dict[str, Any]]:
    """The quantities that are known for at least one pair, as arrays of combinations x pairs.

    Parameters
    ----------
    rows : pl.DataFrame
        Rows of one dataset and machine.
    positions : two (rows,) int64
        Combination and pair of each row.
    shape : (int, int)
        Combinations and pairs.
    succeeded : sequence of str
        Statuses that count as a success.
    criteria : sequence of Criterion
        Criteria of the score.
    """
    found = {}
    for column in columns_for(criteria):
        values = column_values(rows, column, positions, shape, succeeded)
        if values is not None:
            found[column.name] = {
                "unit": column.unit,
                "better": column.better,
                "definition": column.definition,
                "values": packed_floats(values),
            }
    return found


def column_values(
    rows: pl.DataFrame,
    column: PairColumn,
    positions: tuple[NDArray[np.int64], NDArray[np.int64]],
    shape: tuple[int, int],
    succeeded: Sequence[str],
) -> NDArray[np.float64] | None:
    """(combinations, pairs) float64 of one figure, NaN where it is not known; None if it never is.

    The parameters are those of `column_facts`.
    """
    numbers = _numbers(rows, column.source or column.name)
    if numbers is None:
        return None
    success = rows["status"].is_in(list(succeeded)).to_numpy()
    values = np.full(shape, np.nan)
    values[positions] = np.where(success, numbers, np.nan) if column.of_success else numbers
    return None if np.isnan(values).all() else values


def _numbers(rows: pl.DataFrame, source: str) -> NDArray[np.float64] | None:
    """(rows,) float64, NaN where not finite; None if the column is missing."""
    import polars as pl

    try:
        values = rows[source] if source in rows.columns else rows.select(pl.sql_expr(source))
    except pl.exceptions.PolarsError:
        return None
    series = values if isinstance(values, pl.Series) else values.to_series()
    numbers = series.cast(pl.Float64).fill_null(float("nan")).to_numpy()
    return np.where(np.isfinite(numbers), numbers, np.nan)


def matrix_positions(
    rows: pl.DataFrame, combinations: Mapping[str, int], pairs: Mapping[int, int]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Positions of the combination and the pair of each row."""
    names = rows.select(combination_name()).to_series()
    return (
        np.array([combinations[name] for name in names], dtype=np.int64),
        np.array([pairs[pair] for pair in rows["pair"]], dtype=np.int64),
    )


def criterion_facts(criteria: Sequence[Criterion] = CRITERIA) -> list[dict[str, Any]]:
    """Criteria in the payload."""
    return [
        {
            "name": each.name,
            "better": each.better,
            "description": each.description,
            "aspect": each.aspect,
            "reconstruction": each.reconstruction,
        }
        for each in criteria
    ]
