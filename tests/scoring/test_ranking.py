"""The ranking as a table, and everything that goes with it."""

from __future__ import annotations

from typing import Any

import numpy as np
import polars as pl
import pytest

from aerocues.errors import ArgumentError, ScoreError
from aerocues.scoring import Criterion, DecisionTable, ScoreSettings, rank_alternatives
from aerocues.scoring.per_repeat import interval_of_repeats
from tests.scoring.tables import random_table, table_of

COLUMNS = [
    "rank",
    "rank_low",
    "rank_high",
    "score",
    "score_low",
    "score_high",
    "probability_best",
    "probability_top",
    "p_value",
    "success_rate",
    "repeats",
]


def test_five_laptops_by_four_criteria_and_three_runs() -> None:
    generator = np.random.default_rng(0)
    frame = pl.DataFrame(
        [
            {
                "laptop": f"laptop {number}",
                "run": run,
                "frames": 30 + 5 * number + generator.normal(),
                "battery": 8 + number + generator.normal() / 10,
                "noise": 40 - 3 * number + generator.normal(),
                "price": 900.0 - 20 * number,
            }
            for number in range(5)
            for run in range(3)
        ]
    )
    criteria = [
        Criterion("frames"),
        Criterion("battery"),
        Criterion("noise", "lower"),
        Criterion("price", "lower"),
    ]
    table = DecisionTable.from_frame(frame, alternative="laptop", repeat="run", criteria=criteria)
    found = rank_alternatives(table).frame("laptop")
    assert found.columns == ["laptop", *COLUMNS, "frames", "battery", "noise", "price"]
    assert found["laptop"].to_list() == [f"laptop {number}" for number in (4, 3, 2, 1, 0)]
    assert found["rank"].to_list() == [1, 2, 3, 4, 5]
    assert found["success_rate"].to_list() == [1] * 5
    assert found["repeats"].to_list() == [3] * 5
    assert found["probability_best"][0] == 1
    assert found["price"].to_list() == pytest.approx([820, 840, 860, 880, 900])


def test_the_frame_holds_what_was_computed() -> None:
    ranking = rank_alternatives(random_table(0), resamples=60, seed=3, top_k=2)
    frame, scores, order = ranking.frame(), ranking.scores, ranking.scores.order
    low, high = ranking.resampled.score_interval()
    np.testing.assert_allclose(frame["score"].to_numpy(), scores.scores[order])
    np.testing.assert_allclose(frame["score_low"].to_numpy(), low[order])
    np.testing.assert_allclose(frame["score_high"].to_numpy(), high[order])
    np.testing.assert_allclose(frame["c1"].to_numpy(), scores.means[order, 1])
    top = ranking.resampled.probability_in_top(2)[order]
    np.testing.assert_allclose(frame["probability_top"].to_numpy(), top)
    assert frame["p_value"].null_count() == 1
    assert frame["p_value"][0] is None
    kept = frame.filter(pl.col("p_value") >= 0.05)["alternative"].to_list()
    assert ranking.indistinguishable() == kept


def test_the_interval_of_the_thesis_is_an_option() -> None:
    ranking = rank_alternatives(random_table(0), resamples=60, seed=3, interval="pairwise")
    low, high = interval_of_repeats(ranking.scores, 60, seed=3)
    order = ranking.scores.order
    np.testing.assert_allclose(ranking.frame()["score_low"].to_numpy(), low[order])
    np.testing.assert_allclose(ranking.frame()["score_high"].to_numpy(), high[order])


def test_weights_by_criterion_and_method() -> None:
    ranking = rank_alternatives(random_table(0), resamples=5)
    weights = ranking.weights()
    assert weights.columns == ["criterion", "entropy", "variance", "critic", "pca", "aggregate"]
    assert weights["criterion"].to_list() == ["c0", "c1", "c2", "c3"]
    four = weights.select("entropy", "variance", "critic", "pca").to_numpy()
    np.testing.assert_allclose(weights["aggregate"].to_numpy(), four.mean(axis=1))


def test_what_has_no_score_is_named_and_left_out() -> None:
    values = random_table(0).values.copy()
    values[[2, 5]] = np.nan
    ranking = rank_alternatives(table_of(values), ScoreSettings(failures="omit"), resamples=5)
    assert ranking.unscored() == ["a2", "a5"]
    assert len(ranking.frame()) == 6
    assert ranking.frame()["rank"].null_count() == 0


def test_settings_tell_everything() -> None:
    table = table_of(random_table(0).values, blocks=[0, 1, 2, 3, 4, 4])
    ranking = rank_alternatives(table, resamples=7, seed=2, test="wilcoxon", top_k=3)
    assert ranking.settings() == {
        "alpha": 0.5,
        "weights": ("entropy", "variance", "critic", "pca"),
        "aggregation": "arithmetic",
        "failures": "worst",
        "bounds": "measured",
        "needs_first": False,
        "criteria": ["c0", "c1", "c2", "c3"],
        "repeats": 6,
        "resamples": 7,
        "resampled": "block",
        "seed": 2,
        "interval": "joint",
        "top_k": 3,
        "test": "wilcoxon",
        "against": ranking.frame()["alternative"][0],
    }


@pytest.mark.parametrize("name", ["score", "rank", "alternative", "repeats"])
def test_a_criterion_must_not_hide_another_column(name: str) -> None:
    frame = pl.DataFrame({"laptop": ["a", "b"], "figure": [1.0, 2.0]})
    table = DecisionTable.from_frame(
        frame, alternative="laptop", criteria=[Criterion(name, column="figure")]
    )
    with pytest.raises(ScoreError, match=name):
        rank_alternatives(table, resamples=5).frame()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"interval": "wide"}, "joint, pairwise, got 'wide'"),
        ({"test": "sign"}, "bootstrap, wilcoxon, got 'sign'"),
        ({"resamples": 1}, "resamples"),
        ({"seed": -1}, "seed"),
    ],
)
def test_arguments_that_do_not_exist(options: dict[str, Any], message: str) -> None:
    with pytest.raises(ArgumentError, match=message):
        rank_alternatives(random_table(0), **options)
