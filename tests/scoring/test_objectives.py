from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from aerocues.errors import ScoreError
from aerocues.scoring.criteria import Criterion, criteria_named
from aerocues.scoring.objectives import OBJECTIVES, Objective
from aerocues.scoring.settings import SCORE_PRESETS

CRITERIA = (
    Criterion("recall", aspect="accuracy"),
    Criterion("precision", aspect="accuracy"),
    Criterion("inliers", aspect="quantity"),
    Criterion("seconds", "lower", aspect="speed"),
)
ESTIMATED = np.array([0.1, 0.3, 0.4, 0.2])


def test_shares_are_divided_within_an_aspect_as_estimated() -> None:
    objective = Objective("o", "", "", shares={"accuracy": 0.8, "quantity": 0.2})
    np.testing.assert_allclose(objective.weights(ESTIMATED, CRITERIA), [0.2, 0.6, 0.2, 0.0])
    even = objective.weights(np.array([0.0, 0.0, 0.5, 0.5]), CRITERIA)
    np.testing.assert_allclose(even, [0.4, 0.4, 0.2, 0.0])
    # What there is no criterion for gives its share to the others.
    np.testing.assert_allclose(objective.weights(ESTIMATED[:2], CRITERIA[:2]), [0.25, 0.75])


def test_efficiency_leaves_weights_as_they_are() -> None:
    np.testing.assert_array_equal(OBJECTIVES["efficiency"].weights(ESTIMATED, CRITERIA), ESTIMATED)


def test_sixteen_times_the_time_must_be_twice_as_good() -> None:
    speed = OBJECTIVES["speed"]
    np.testing.assert_allclose(speed.hurry(np.array([1.0, 16.0, 0.0625])), [0.5, 0.25, 1.0])
    plain = replace(SCORE_PRESETS["inliers"], criteria=("recall",))
    assert speed.criteria(plain) == ("recall", "total_seconds")
    timed = replace(plain, criteria=("total_seconds",))
    assert speed.criteria(timed) == ("total_seconds",)
    assert OBJECTIVES["efficiency"].criteria(plain) == ("recall",)
    assert OBJECTIVES["reconstruction"].criteria(SCORE_PRESETS["models"]) == (
        "expected_quality",
        "links",
    )


def test_robust_is_the_mean_of_the_worst_quarter_of_the_scenes() -> None:
    robust = OBJECTIVES["robust"]
    scores = np.array([[0.9, 0.1, 0.8, 0.7, 0.3, 0.6, 0.5, 0.4], [0.5] * 8])
    np.testing.assert_allclose(robust.over_blocks(scores), [0.2, 0.5])
    np.testing.assert_allclose(robust.over_blocks(scores[:, :3]), [0.1, 0.5])


@pytest.mark.parametrize("name", OBJECTIVES)
@pytest.mark.parametrize("references", [True, False])
def test_every_objective_weighs_what_its_preset_measures(name: str, references: bool) -> None:
    objective = OBJECTIVES[name]
    scoring = objective.scoring(references=references)
    assert scoring.name == (objective.preset if references else "inliers")
    assert objective.scoring(references=False, chance_test=False).name == "thesis"
    criteria = criteria_named(objective.criteria(scoring))
    weights = objective.weights(np.full(len(criteria), 1 / len(criteria)), criteria)
    assert weights.sum() == pytest.approx(1)
    for aspect, share in objective.shares.items():
        own = [criterion.aspect == aspect for criterion in criteria]
        assert weights[own].sum() == pytest.approx(share)


def test_what_cannot_be_weighed_is_told() -> None:
    with pytest.raises(ScoreError, match="accuracy, quantity"):
        OBJECTIVES["accuracy"].weights(np.ones(1), (Criterion("price", "lower"),))
