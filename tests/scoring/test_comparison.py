"""Rankings across data sets."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.stats import kendalltau, spearmanr

from aerocues.errors import ScoreError
from aerocues.scoring import score
from aerocues.scoring.across import compare_datasets, entries_of, machines_of
from aerocues.scoring.compared import compare_entries
from aerocues.scoring.comparison import compare
from aerocues.scoring.cues import Scores
from tests.scoring.measurements import Stored, models, row, rows
from tests.scoring.tables import table_of

NAMES = ("a", "b", "c", "d", "e")


def scored(values: dict[str, float]) -> Scores:
    """Scores that fall as given: one criterion, one repeat."""
    array = np.array(list(values.values())).reshape(-1, 1, 1)
    return score(table_of(array, names=list(values)))


def test_correlations_are_those_of_scipy_over_what_both_have() -> None:
    first = dict(zip(NAMES, (5.0, 4, 3, 2, 1), strict=True))
    second = dict(zip(NAMES, (4.0, 5, 1, 2, 3), strict=True))
    third = {"a": 1.0, "b": 2.0, "c": 3.0, "x": 9.0}
    rankings = {"one": scored(first), "two": scored(second), "three": scored(third)}
    found = compare(rankings)
    values = list(first.values()), list(second.values())
    assert found.spearman()[0, 1] == pytest.approx(spearmanr(*values).statistic)
    assert found.kendall()[0, 1] == pytest.approx(kendalltau(*values).statistic)
    assert found.spearman()[0, 2] == pytest.approx(-1)
    np.testing.assert_array_equal(found.shared(), [[5, 5, 3], [5, 5, 3], [3, 3, 4]])
    in_all = compare(rankings, "all")
    np.testing.assert_array_equal(in_all.shared(), np.full((3, 3), 3))
    expected = spearmanr(values[0][:3], values[1][:3]).statistic
    assert in_all.spearman()[0, 1] == pytest.approx(expected)


def test_versatility_is_mean_least_and_spread() -> None:
    rankings = {
        "one": scored({"a": 1.0, "b": 0.25, "c": 0.0}),
        "two": scored({"a": 0.0, "b": 1.0, "c": 0.25, "x": 0.5}),
    }
    found = compare(rankings).versatility()
    # A single criterion weighs 1; CUES is the root of the normalised value.
    assert found["alternative"].to_list() == ["b", "a", "c", "x"]
    b = found.row(0, named=True)
    assert (b["mean"], b["min"], b["spread"]) == pytest.approx((0.75, 0.5, 0.5))
    assert b["standard_deviation"] == pytest.approx(0.25)
    assert (b["mean_rank"], b["worst_rank"], b["datasets"]) == (1.5, 2, 2)
    assert (b["score_one"], b["score_two"]) == pytest.approx((0.5, 1.0))
    assert (b["rank_one"], b["rank_two"]) == (2, 1)
    x = found.row(3, named=True)
    assert (x["datasets"], x["score_one"], x["rank_two"]) == (1, None, 2)


def test_machines_of_one_data_set_count_as_one() -> None:
    rankings = {
        "desk": scored({"a": 1.0, "b": 0.25, "c": 0.0}),
        "board": scored({"a": 1.0, "b": 0.0, "c": 0.25}),
        "flight": scored({"a": 0.0, "b": 1.0, "c": 0.25}),
    }
    found = compare(rankings, datasets=("oxford", "oxford", "flight")).versatility()
    by_name = {row["alternative"]: row for row in found.to_dicts()}
    # b: 0.5 and 0 on oxford, 1 on the flight.
    assert by_name["b"]["mean"] == pytest.approx((0.25 + 1) / 2)
    assert by_name["b"]["min"] == pytest.approx(0.25)
    assert by_name["b"]["datasets"] == 2
    assert by_name["b"]["score_board"] == 0


def test_data_sets_may_be_called_as_they_like() -> None:
    one = scored({"a": 1.0, "b": 2.0, "c": 3.0})
    found = compare({"mean": one, "alternative": one, "min": one}).versatility()
    assert found["score_mean"].to_list() == found["score_min"].to_list()


def test_what_cannot_be_compared_is_told() -> None:
    one = scored({"a": 1.0, "b": 2.0})
    with pytest.raises(ScoreError, match="two"):
        compare({"one": one})
    with pytest.raises(ScoreError, match="alternative"):
        compare({"one": one, "two": scored({"c": 1.0, "d": 2.0})})
    with pytest.raises(ScoreError, match="pairwise or all"):
        compare({"one": one, "two": one}, "some")  # type: ignore[arg-type]


class InFolder(Stored):
    """Made-up results that claim to lie somewhere."""

    def __init__(self, folder: str, **changes: object) -> None:
        combinations = ("ORB-ORB-HAM-BF", "SIFT-SIFT-L2-BF", "KAZE-KAZE-L2-BF")
        super().__init__(
            rows(
                *(
                    row(name, pair, inliers=30 + 10 * number + pair, **changes)
                    for number, name in enumerate(combinations)
                    for pair in (0, 1)
                )
            )
        )
        self.folder = Path(folder)
        self.settings: dict[str, Any] = {}


@pytest.mark.parametrize(
    ("results", "names"),
    [
        ([InFolder("r", dataset="x"), InFolder("s", dataset="y")], ["x", "y"]),
        ([InFolder("r"), InFolder("s", machine="board")], ["flight (desk)", "flight (board)"]),
        ([InFolder("r"), InFolder("s")], ["r", "s"]),
        (
            [InFolder("r", preset="default"), InFolder("s", preset="tuned")],
            ["flight (default)", "flight (tuned)"],
        ),
        (
            [InFolder("r", opencv_version="4.13.0"), InFolder("s", opencv_version="5.0.0")],
            ["flight (OpenCV 4.13.0)", "flight (OpenCV 5.0.0)"],
        ),
        ([InFolder("p/r"), InFolder("q/r")], ["1 flight", "2 flight"]),
        (
            [InFolder("r", machine=None), InFolder("s")],
            ["flight (unknown machine)", "flight (desk)"],
        ),
    ],
)
def test_results_have_the_shortest_names_that_differ(
    results: list[InFolder], names: list[str]
) -> None:
    assert [entry.name for entry in entries_of(results)] == names


def test_the_same_results_twice_are_refused() -> None:
    with pytest.raises(ScoreError, match="twice"):
        entries_of([InFolder("r"), InFolder("r")])


def test_one_folder_may_hold_several_datasets() -> None:
    both = InFolder("r")
    both._table = both.table().vstack(InFolder("s", dataset="other").table())
    entries = entries_of([both])
    assert [entry.name for entry in entries] == ["flight", "other"]
    assert compare_datasets(entries).spearman()[0, 1] == pytest.approx(1)
    assert machines_of(entries) == []
    assert compare_entries(entries).runs == []


def test_rankings_by_different_presets_are_not_compared() -> None:
    untested = InFolder("s", chance_inliers=None, excess_inliers=None, dataset="other")
    with pytest.raises(ScoreError, match="preset"):
        entries_of([InFolder("r"), untested])
    assert len(entries_of([InFolder("r"), untested], "thesis")) == 2


def test_the_same_data_set_on_two_machines_is_compared_by_times() -> None:
    slow = InFolder("s", machine="board", match_seconds=1.2, total_seconds=2.0)
    entries = entries_of([InFolder("r"), slow, InFolder("t", dataset="other")])
    compared = compare_entries(entries)
    (found,) = compared.runs
    assert (found.first.machine, found.second.machine) == ("desk", "board")
    assert not isinstance(found.times, str)
    by_stage = {each["stage"]: each for each in found.times.to_dicts()}
    assert by_stage["match"]["ratio"] == pytest.approx(3)
    assert by_stage["total"]["ratio"] == pytest.approx(2)
    assert by_stage["detect"]["ratio"] == pytest.approx(1)
    assert not compared.of_one_dataset
    assert "mean_rank" in compared.frame().columns


def test_models_count_where_a_data_set_has_them() -> None:
    flown, other = InFolder("r"), InFolder("s", dataset="other")
    flown._reconstructions = models(
        {"ORB-ORB-HAM-BF": (0.5, 1000, 9), "SIFT-SIFT-L2-BF": (0.6, 2000, 12)}
    )
    entries = entries_of([flown, other], reconstruction=True)
    assert [entry.criteria_of_models for entry in entries] == [3, 0]
    # The third has no model, and therefore no score by models.
    assert compare_datasets(entries).shared()[0].tolist() == [2, 2]
    with pytest.raises(ScoreError, match="reconstruct"):
        entries_of([InFolder("r"), other], reconstruction=True)
