from __future__ import annotations

import numpy as np
import pytest

from aerocues.errors import ScoreError
from aerocues.tuning.yardstick import mean_difference, yardstick


def test_one_criterion_counts_by_its_mean_and_a_failure_by_the_worst() -> None:
    values = np.array([[[10.0], [20.0]], [[np.nan], [40.0]]])
    inliers = yardstick("excess_inliers")
    np.testing.assert_allclose(inliers.scores(values), [15.0, 20.0])
    np.testing.assert_allclose(inliers.on_others(values, values), [[10, 20], [0, 40]])
    seconds = yardstick("total_seconds")
    np.testing.assert_allclose(seconds.scores(values), [-15.0, -40.0])


def test_cues_ranks_what_is_better_in_everything_first() -> None:
    rng = np.random.default_rng(0)
    cues = yardstick("cues")
    costs = np.array([criterion.better == "lower" for criterion in cues.criteria])
    quality = np.array([0.2, 0.8, 0.5])[:, None, None] + 0.05 * rng.random((3, 6, len(costs)))
    values = np.where(costs, 1 - quality, quality)
    scores = cues.scores(values)
    assert np.argsort(-scores).tolist() == [1, 2, 0]
    others = cues.on_others(values, values[[0, 1]])
    assert others.shape == (2, 6)
    assert (others[1] > others[0]).all()
    # A candidate that fails everywhere is worth nothing.
    values[2] = np.nan
    assert np.argmin(cues.scores(values)) == 2


def test_the_interval_covers_the_mean() -> None:
    first = np.zeros(50)
    second = np.random.default_rng(1).normal(0.3, 0.1, 50)
    mean, low, high = mean_difference(first, second, 0)
    assert low < 0.3 < high
    assert mean == pytest.approx(second.mean())
    assert (mean - low) == pytest.approx(1.96 * second.std() / np.sqrt(50), rel=0.15)
    assert mean_difference(first, second, 0) == mean_difference(first, second, 0)


def test_unknown_criteria_are_told() -> None:
    with pytest.raises(ScoreError, match="no criterion 'beauty'"):
        yardstick("beauty")
