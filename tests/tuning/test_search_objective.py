from __future__ import annotations

import numpy as np
import pytest

from aerocues.errors import ScoreError
from aerocues.tuning.search_objective import mean_gain, search_objective


def test_one_criterion_counts_by_its_mean_and_a_failure_by_the_worst() -> None:
    values = np.array([[[10.0], [20.0]], [[np.nan], [40.0]]])
    inliers = search_objective("excess_inliers")
    assert not inliers.reference
    np.testing.assert_allclose(inliers.scores(values), [15.0, 20.0])
    np.testing.assert_allclose(inliers.on_others(values, values), [[10, 20], [0, 40]])
    seconds = search_objective("total_seconds")
    np.testing.assert_allclose(seconds.scores(values), [-15.0, -40.0])


def test_cues_ranks_what_is_better_in_everything_first() -> None:
    rng = np.random.default_rng(0)
    cues = search_objective("cues")
    assert cues.reference  # right matches count, as where combinations are scored
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


def test_the_interval_of_pairs_is_that_of_student() -> None:
    gains = np.array([0.1, 0.2, 0.4])
    for scenes in ([0, 0, 0], [0, 0, 1], [0, 1, 2]):
        mean, low, high = mean_gain(gains, scenes)
        assert mean == pytest.approx(gains.mean())
        # 4.303: the quantile of two degrees of freedom.
        assert mean - low == pytest.approx(4.303 * gains.std(ddof=1) / np.sqrt(3), rel=1e-3)
        assert high - mean == pytest.approx(mean - low)


def test_scenes_count_by_their_means_and_their_pairs() -> None:
    gains = np.array([0.1, 0.3, 0.2, 0.5, 0.3])
    mean, low, _ = mean_gain(gains, ["a", "a", "b", "c", "c"])
    assert mean == pytest.approx(gains.mean())
    error = np.std([0.2, 0.2, 0.4], ddof=1) * np.sqrt(0.4**2 + 0.2**2 + 0.4**2)
    assert mean - low == pytest.approx(4.303 * error, rel=1e-3)


@pytest.mark.parametrize("spread", [0, 1, 3])
@pytest.mark.parametrize(
    "sizes",
    [
        *([1] * pairs for pairs in (2, 3, 4, 5, 8, 16)),
        *([2, 2, 2], [1, 1, 6], [2, 2, 5, 5], [4] * 4, [1, 1, 1, 1, 12]),
    ],
    ids=str,
)
def test_what_has_no_effect_seldom_pays(sizes: list[int], spread: int) -> None:
    """At most the nominal 2.5 % and what 2,000 draws leave open, however much scenes differ."""
    rng = np.random.default_rng(0)
    scenes = np.repeat(np.arange(len(sizes)), sizes)
    draws = 2000
    gains = rng.normal(size=(draws, len(scenes)))
    gains += spread * rng.normal(size=(draws, len(sizes)))[:, scenes]
    paid = sum(mean_gain(each, scenes.tolist())[1] > 0 for each in gains)
    assert paid / draws < 0.04


@pytest.mark.parametrize("pairs", [3, 8, 16])
def test_one_scene_holds_the_level_on_its_own_pairs(pairs: int) -> None:
    gains = np.random.default_rng(0).normal(size=(2000, pairs))
    assert sum(mean_gain(each, [0] * pairs)[1] > 0 for each in gains) / 2000 < 0.04


def test_the_least_gain_of_a_criterion_is_relative() -> None:
    default = np.array([300.0, 500.0])
    assert search_objective("excess_inliers").least_gain(default) == pytest.approx(2.0)
    assert search_objective("total_seconds").least_gain(-default / 1000) == pytest.approx(0.002)
    assert search_objective("cues").least_gain(np.array([0.2, 0.4])) == pytest.approx(0.005)


def test_unknown_criteria_are_told() -> None:
    with pytest.raises(ScoreError, match="'beauty'"):
        search_objective("beauty")
    with pytest.raises(ScoreError, match="points_3d"):
        search_objective("points_3d")
