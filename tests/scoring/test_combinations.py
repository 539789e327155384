"""From measured rows to a table of combinations and its ranking."""

from __future__ import annotations

import numpy as np
import polars as pl
import pytest

from aerocues.errors import ScoreError
from aerocues.scoring import SCORE_PRESETS, criteria_named
from aerocues.scoring.assessment import score
from aerocues.scoring.combinations import decision_table, suitable_preset
from aerocues.scoring.measured import settings_from, table_of
from tests.scoring.measurements import Stored, models, row, rows

ORB, SIFT, AKAZE = "ORB-ORB-HAM-BF", "SIFT-SIFT-L2-FLANN", "AKAZE-SIFT-L2-BF"


def test_a_table_has_combinations_pairs_and_criteria() -> None:
    table = decision_table(
        rows(row(ORB, 0, inliers=40), row(ORB, 1, inliers=60), row(SIFT, 0, inliers=50)),
        criteria_named(["inliers", "matches"]),
    )
    assert table.alternatives == (ORB, SIFT)
    assert table.repeats == ("0", "1")
    np.testing.assert_array_equal(table.values[0, :, 0], [40, 60])
    np.testing.assert_array_equal(table.values[1, :, 0], [50, np.nan])
    assert not table.failed.any()  # SIFT was not measured on pair 1, which is no failure
    assert table.tried.tolist() == [2, 1]
    assert table.components["detectors"] == ("ORB", "SIFT")
    assert table.components["detector-descriptor pairs"] == ("ORB-ORB", "SIFT-SIFT")
    assert table.components["matchers"] == ("BF", "FLANN")


def test_sequences_are_the_blocks() -> None:
    table = decision_table(
        rows(row(ORB, 0), row(ORB, 1, sequence="two"), row(ORB, 2, sequence="two")),
        criteria_named(["inliers"]),
    )
    assert table.blocks[1] == table.blocks[2] != table.blocks[0]


def test_a_failed_row_has_no_value_whatever_it_holds() -> None:
    given = rows(row(ORB, 0), row(SIFT, 0, status="chance"), row(AKAZE, 0, status="timeout"))
    criteria = criteria_named(["inliers", "recall_beyond_chance"])
    table = decision_table(given, criteria)
    assert table.alternatives == (AKAZE, ORB, SIFT)
    assert table.failed.all(axis=(1, 2)).tolist() == [True, False, True]
    assert table.success_rate.tolist() == [0, 1, 0]
    without_test = decision_table(given, criteria, chance_fails=False)
    assert without_test.failed.any(axis=(1, 2)).tolist() == [True, False, False]


def test_criteria_beyond_chance_follow_from_the_counts() -> None:
    criteria = criteria_named(
        [
            "recall_beyond_chance",
            "repeatability_beyond_chance",
            "f1_beyond_chance",
            "seconds_per_1k_excess_inliers",
        ]
    )
    given = row(ORB, 0, inliers=50, matches=200, keypoints_1=800, keypoints_2=500)
    table = decision_table(rows(given), criteria)
    precision, recall = 40 / 200, 40 / 800
    expected = [recall, 40 / 500, 2 * precision * recall / (precision + recall), 1000 / 40]
    np.testing.assert_allclose(table.values[0, 0], expected)


def test_no_inlier_beyond_chance_leaves_the_time_for_them_undefined() -> None:
    criteria = criteria_named(["excess_inliers", "seconds_per_1k_excess_inliers"])
    given = rows(row(ORB, 0), row(SIFT, 0, excess_inliers=0.0))
    table = decision_table(given, criteria)
    assert table.values[1, 0, 0] == 0
    assert table.failed[1, 0].tolist() == [False, True]


@pytest.mark.parametrize(
    ("given", "criteria", "told"),
    [
        (rows(row(ORB, 0)).clear(), ["inliers"], "rows"),
        (rows(row(ORB, 0), row(ORB, 0, dataset="other")), ["inliers"], "flight"),
        (rows(row(ORB, 0)), ["points_3d"], "image pairs"),
        (rows(row(ORB, 0)), ["inliers", "points_3d"], "points_3d"),
        (rows(row(ORB, 0)), ["gt_repeatability"], "'gt_repeatability'"),
    ],
)
def test_what_cannot_be_arranged_is_told(given: object, criteria: list[str], told: str) -> None:
    with pytest.raises(ScoreError, match=told):
        decision_table(given, criteria_named(criteria))  # type: ignore[arg-type]


def test_the_preset_suits_the_measurements() -> None:
    assert suitable_preset(rows(row(ORB, 0))).name == "inliers"
    untested = rows(row(ORB, 0, chance_inliers=None, excess_inliers=None))
    assert suitable_preset(untested).name == "thesis"
    assert table_of(Stored(untested)).preset.name == "thesis"
    with pytest.raises(ScoreError, match="thesis"):
        table_of(Stored(untested), "inliers")


def test_one_of_several_datasets_is_chosen() -> None:
    results = Stored(rows(row(ORB, 0), row(SIFT, 0), row(ORB, 0, dataset="other", inliers=20)))
    with pytest.raises(ScoreError, match="flight, other"):
        table_of(results)
    with pytest.raises(ScoreError, match="'third'"):
        table_of(results, dataset="third")
    assert table_of(results, dataset="other").table.alternatives == (ORB,)


MEASURED = rows(*(row(name, pair) for name in (ORB, SIFT, AKAZE) for pair in (0, 1)))


def test_reconstructions_join_where_most_have_one() -> None:
    found = models({ORB: (0.5, 9000, 20), SIFT: None})
    measured = table_of(Stored(MEASURED, found))
    assert measured.table.criterion_names[-3:] == measured.preset.reconstruction_criteria
    by_name = dict(zip(measured.table.alternatives, range(3), strict=True))
    np.testing.assert_array_equal(measured.table.values[by_name[ORB], :, -2], [9000, 9000])
    assert measured.table.failed[by_name[SIFT], :, -3:].all()
    assert not measured.table.failed[by_name[AKAZE]].any()
    # Only the pairs say how often a combination succeeds.
    assert measured.table.success_rate.tolist() == [1, 1, 1]
    ranking = score(Stored(MEASURED, found), resamples=10)
    assert ranking.unscored() == [AKAZE]
    assert ranking.frame("combination")["combination"].to_list() == [ORB, SIFT]


def test_a_few_reconstructions_do_not_cost_the_others_their_score() -> None:
    results = Stored(MEASURED, models({ORB: (0.5, 9000, 20)}))
    assert "points_3d" not in table_of(results).table.criterion_names
    asked = table_of(results, reconstruction=True)
    assert "points_3d" in asked.table.criterion_names
    both = Stored(MEASURED, models({ORB: (0.5, 9000, 20), SIFT: (0.6, 8000, 30)}))
    assert "points_3d" in table_of(both).table.criterion_names
    assert "points_3d" not in table_of(both, reconstruction=False).table.criterion_names
    assert "points_3d" not in table_of(both, criteria=["inliers"]).table.criterion_names


def test_reconstructions_of_others_are_of_no_use() -> None:
    results = Stored(MEASURED, models({"KAZE-KAZE-L2-BF": (0.5, 9000, 20)}))
    with pytest.raises(ScoreError):
        table_of(results, criteria=["inliers", "points_3d"])


def test_settings_of_a_preset_can_be_changed() -> None:
    preset = SCORE_PRESETS["thesis"]
    assert settings_from(preset, alpha=None, failures=None) == preset.settings
    changed = settings_from(preset, alpha=0.25, failures="worst")
    assert (changed.alpha, changed.failures) == (0.25, "worst")
    assert changed.weights == preset.settings.weights
    with pytest.raises(ScoreError, match="alpha"):
        settings_from(preset, alpha=0)


def test_failing_on_the_hard_pair_pays_by_the_thesis_and_costs_by_default() -> None:
    steady = [row(ORB, 0, inliers=80), row(ORB, 1, inliers=30)]
    fragile = [row(SIFT, 0, inliers=80), row(SIFT, 1, status="no_model")]
    results = Stored(rows(*steady, *fragile))
    by_thesis = score(results, "thesis", resamples=10).frame()
    by_default = score(results, resamples=10).frame()
    assert by_thesis["combination"].to_list() == [SIFT, ORB]
    assert by_default["combination"].to_list() == [ORB, SIFT]
    assert by_default["success_rate"].to_list() == [1.0, 0.5]


def test_criteria_of_a_reconstruction_may_be_expressions() -> None:
    whole = models({ORB: (0.5, 9000, 20), SIFT: (0.4, 20, 9), AKAZE: None}).with_columns(
        pl.Series("status", ["ok", "incomplete", "error"]),
        pl.Series("registered_images", [16, 4, None]),
        images=pl.lit(20),
    )
    names = ["precision", "points_3d", "registered_share"]
    table = table_of(Stored(MEASURED, whole), criteria=names).table
    by_name = dict(zip(table.alternatives, range(3), strict=True))
    np.testing.assert_array_equal(table.values[by_name[ORB], :, 1:], [[9000, 0.8]] * 2)
    # A model that is no success has failed, though it has images and points.
    for failed in (SIFT, AKAZE):
        assert table.failed[by_name[failed], :, 1:].all()
        assert np.isnan(table.values[by_name[failed], :, 1:]).all()
