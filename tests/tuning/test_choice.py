"""The best combination for a purpose, from finished measurements."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import aerocues
from aerocues.errors import AerocuesError, ArgumentError, ScoreError
from aerocues.scoring.finished import filled
from aerocues.scoring.objectives import OBJECTIVES
from aerocues.tuning.choice import Choice, choose
from tests.scoring.measurements import Stored, row, rows
from tests.scoring.tables import table_of

NAMES = ("ORB-ORB-HAM-BF", "SIFT-SIFT-L2-BF", "KAZE-KAZE-L2-BF", "STAR-BRIEF-HAM-BF")
COSTS: dict[str, dict[str, Any]] = {
    "ORB-ORB-HAM-BF": {"total_seconds": 0.1, "descriptor_bytes": 32, "peak_memory_mb": 90.0},
    "SIFT-SIFT-L2-BF": {"total_seconds": 0.8, "descriptor_bytes": 512, "peak_memory_mb": 200.0},
    "KAZE-KAZE-L2-BF": {"total_seconds": 1.6, "descriptor_bytes": 256, "peak_memory_mb": 700.0},
    "STAR-BRIEF-HAM-BF": {"total_seconds": 0.05, "descriptor_bytes": 16, "peak_memory_mb": 50.0},
}


def measured(dataset: str = "flight", *, inliers: tuple[int, ...] = (50, 70, 80, 30)) -> Stored:
    """Four combinations on six pairs: more inliers, more time."""
    return Stored(
        rows(
            *(
                row(name, pair, dataset=dataset, inliers=number + pair % 3, **COSTS[name])
                for name, number in zip(NAMES, inliers, strict=True)
                for pair in range(6)
            )
        )
    )


def names(found: Choice) -> list[str]:
    return found.ranked["combination"].to_list()


def test_efficiency_is_the_score() -> None:
    found = choose(measured(), "efficiency", resamples=20)
    expected = aerocues.score(measured(), resamples=20).frame("combination")
    assert found.presets == ("inliers",)
    assert names(found) == expected["combination"].to_list()
    np.testing.assert_allclose(found.ranked["score"], expected["score"])
    assert found.best == "SIFT-SIFT-L2-BF"
    assert found.ranked["probability"].sum() == pytest.approx(1)
    assert "SIFT-SIFT-L2-BF" in repr(found)


@pytest.mark.parametrize(
    ("limits", "kept"),
    [
        ({"max_seconds_per_image": 0.8}, {NAMES[0], NAMES[1], NAMES[3]}),
        ({"max_seconds_per_image": "50ms"}, {NAMES[3]}),
        ({"max_memory": "0.3GB"}, {NAMES[0], NAMES[1], NAMES[3]}),
        ({"max_memory": 90}, {NAMES[0], NAMES[3]}),
        ({"max_descriptor_bytes": 32}, {NAMES[0], NAMES[3]}),
        ({"combinations": "*,!SIFT-*,!kaze-*"}, {NAMES[0], NAMES[3]}),
        ({"combinations": "*-ham-*,sift-*", "max_descriptor_bytes": 256}, {NAMES[0], NAMES[3]}),
        ({"licence": "permissive"}, set(NAMES)),
    ],
)
def test_limits_leave_out_and_do_not_change_scores(limits: dict[str, Any], kept: set[str]) -> None:
    whole = dict(choose(measured(), "efficiency", resamples=2).ranked[:, :2].iter_rows())
    found = choose(measured(), "efficiency", resamples=2, **limits)
    assert dict(found.ranked[:, :2].iter_rows()) == {name: whole[name] for name in kept}
    assert found.excluded.keys() == set(NAMES) - kept


def test_several_datasets_are_averaged() -> None:
    other = measured("board", inliers=(90, 30, 40, 20))
    found = choose([measured(), other], "efficiency", resamples=20)
    assert found.datasets == ("flight", "board")
    assert found.pairs == 12
    for best in found.ranked.iter_rows(named=True):
        assert best["score"] == pytest.approx((best["score_flight"] + best["score_board"]) / 2)
    # Unknown conditions: the worst quarter of two datasets is the worse of them.
    worst = choose([measured(), other], "robust", resamples=2).ranked
    for each in worst.iter_rows(named=True):
        assert each["score"] == min(each["score_flight"], each["score_board"])


def test_speed_and_controlled_conditions_choose_others() -> None:
    assert choose(measured(), "accuracy", resamples=2).best == "KAZE-KAZE-L2-BF"
    assert choose(measured(), "speed", resamples=2).best == "ORB-ORB-HAM-BF"
    best, worst = (
        choose(measured(), name, resamples=2).ranked["score"][0]
        for name in ("controlled", "robust")
    )
    assert best > worst
    scores = np.array([[0.1, 0.9, 0.5, 0.2]])
    assert OBJECTIVES["controlled"].over_blocks(scores) == [0.9]
    assert OBJECTIVES["robust"].over_blocks(scores) == [0.1]


def test_what_cannot_be_compared_is_left_out() -> None:
    few = measured("other")
    few._table = few.table()[:-4]  # STAR on two of six pairs
    without = few.table().filter(few.table()["detector"] != "KAZE")
    found = choose([measured(), Stored(without)], "efficiency", resamples=2)
    assert found.excluded == {
        "KAZE-KAZE-L2-BF": "not measured on other",
        "STAR-BRIEF-HAM-BF": "measured on fewer than half of the pairs of other",
    }


@pytest.mark.parametrize(
    ("settings", "told"),
    [
        ({"objective": "beauty"}, "objective"),
        ({"max_seconds_per_image": "soon"}, "max_seconds_per_image"),
        ({"max_memory": "3 apples"}, "max_memory"),
        ({"max_memory": 1}, "no combination is within the limits"),
        ({"max_memory": 1, "combinations": "ORB-*"}, "such as ORB-.*memory.*; allow more$"),
        ({"combinations": "NOPE"}, "no measured combination matches 'NOPE'"),
        ({"combinations": "!*"}, "take out fewer combinations$"),
        ({"licence": "mine"}, "licence"),
        ({"seed": -1}, "seed"),
        ({"seed": 1.5}, "seed"),
        ({"dataset": "moon"}, "moon"),
    ],
)
def test_errors_name_the_argument(settings: dict[str, Any], told: str) -> None:
    with pytest.raises(AerocuesError, match=told):
        choose(measured(), resamples=2, **settings)


def test_results_are_given_once_and_at_least_one() -> None:
    with pytest.raises(ArgumentError, match="give at least one result"):
        choose([])
    same = measured()
    with pytest.raises(ScoreError, match="twice"):
        choose([same, same], resamples=2)


def test_results_of_one_dataset_are_numbered() -> None:
    few = measured().table().filter(measured().table()["detector"] != "KAZE")[:-4]
    found = choose([measured(), Stored(few)], "efficiency", resamples=2)
    assert found.excluded == {
        "KAZE-KAZE-L2-BF": "not measured on 2 flight",
        "STAR-BRIEF-HAM-BF": "measured on fewer than half of the pairs of 2 flight",
    }
    assert {"score_1 flight", "score_2 flight"} <= set(found.ranked.columns)


def test_what_was_measured_too_little_is_to_be_measured() -> None:
    table = measured().table()
    one = Stored(table.filter(table["detector"].is_in(["ORB", "STAR"])))
    other = Stored(table.filter(table["detector"].is_in(["SIFT", "KAZE"])))
    with pytest.raises(ScoreError, match=r"is left .*; measure them .* with `aerocues.run`$"):
        choose([one, other], resamples=2, combinations="ORB-*")


def test_what_was_not_measured_cannot_be_limited() -> None:
    lacking = Stored(measured().table().drop("peak_memory_mb"))
    with pytest.raises(ScoreError, match="max_memory"):
        choose(lacking, resamples=2, max_memory=100)


def test_failed_pairs_are_the_worst_and_missing_ones_the_mean() -> None:
    nan = float("nan")
    table = table_of([[[1.0], [3.0]], [[nan], [2.0]], [[nan], [4.0]]])
    failed = np.zeros(table.values.shape, np.bool_)
    failed[1, 0] = True
    values = filled(replace(table, failed=failed))
    np.testing.assert_array_equal(values[..., 0], [[1, 3], [1, 2], [4, 4]])
