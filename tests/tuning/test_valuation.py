from __future__ import annotations

import numpy as np
import pytest

from aerocues.scoring.criteria import Criterion
from aerocues.scoring.cues import score
from aerocues.scoring.objectives import OBJECTIVES
from aerocues.scoring.settings import ScoreSettings
from aerocues.scoring.table import DecisionTable
from aerocues.tuning.valuation import Valuation

CRITERIA = (
    Criterion("precision", aspect="accuracy"),
    Criterion("inliers", aspect="quantity"),
    Criterion("total_seconds", "lower", aspect="speed"),
)


def table(pairs: int = 6) -> np.ndarray:
    rng = np.random.default_rng(1)
    return np.stack(
        [rng.random((9, pairs)), rng.integers(10, 900, (9, pairs)), 1 + rng.random((9, pairs))],
        axis=-1,
    )


def valuation(values: np.ndarray, blocks: np.ndarray, name: str) -> Valuation:
    return Valuation(values, CRITERIA, blocks, ScoreSettings(), OBJECTIVES[name])


def test_what_is_measured_whole_is_worth_its_cues() -> None:
    values = table()
    names = [f"a{number}" for number in range(9)]
    expected = score(DecisionTable.from_values(values, names, CRITERIA))
    balanced = valuation(values, np.zeros(6, np.int64), "balanced")
    np.testing.assert_allclose(balanced.weights, expected.weights)
    np.testing.assert_allclose(balanced.of(values), expected.scores)


def test_time_counts_by_its_fourth_root() -> None:
    values = np.ones((3, 2, 3)) * [[[0.5, 100, 1.0]], [[0.5, 100, 16.0]], [[0.1, 50, 1.0]]]
    scores = valuation(values, np.zeros(2, np.int64), "speed").of(values)
    assert scores[1] == pytest.approx(scores[0] / 2)
    assert scores[2] == pytest.approx(0.0)


def test_robust_scores_the_worst_scene() -> None:
    values = table()
    blocks = np.array([0, 0, 0, 1, 1, 1])
    robust = valuation(values, blocks, "robust")
    by_scene = [robust.of(np.repeat(part.mean(axis=1)[:, None], 6, axis=1)) for part in (
        values[:, :3], values[:, 3:])]  # fmt: skip
    np.testing.assert_allclose(robust.of(values), np.minimum(*by_scene))
    # Of one scene, every pair counts by itself.
    alone = valuation(values, np.zeros(6, np.int64), "robust").of(values)
    assert (alone <= valuation(values, np.zeros(6, np.int64), "balanced").of(values)).all()
