from __future__ import annotations

import numpy as np
import pytest

from aerocues.scoring.criteria import Criterion, criteria_named
from aerocues.scoring.cues import score
from aerocues.scoring.objectives import OBJECTIVES
from aerocues.scoring.settings import SCORE_PRESETS, ScoreSettings
from aerocues.scoring.table import DecisionTable
from aerocues.scoring.valuation import Valuation

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
    efficiency = valuation(values, np.zeros(6, np.int64), "efficiency")
    np.testing.assert_allclose(efficiency.weights, expected.weights)
    np.testing.assert_allclose(efficiency.of(values), expected.scores)


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
    assert (alone <= valuation(values, np.zeros(6, np.int64), "efficiency").of(values)).all()


def test_links_by_class_multiply_what_is_expected() -> None:
    criteria = criteria_named(["expected_quality", "links", "total_seconds"])
    values = np.ones((2, 4, 3))
    values[0, :, 0], values[0, :, 1] = 0.9, [1.0, 1.0, 0.0, 0.0]
    values[1, :, 0], values[1, :, 1] = 0.3, [1.0, 0.5, 0.5, 1.0]
    values[1, :, 2] = 1024.0
    settings, classes = SCORE_PRESETS["models"].settings, np.array([0, 0, 1, 1])
    found = [
        Valuation(
            values[..., : 3 if name == "balanced" else 2],
            criteria[: 3 if name == "balanced" else 2],
            np.zeros(4, np.int64),
            settings,
            OBJECTIVES[name],
            classes=classes,
        ).of(values[..., : 3 if name == "balanced" else 2])
        for name in ("reconstruction", "balanced")
    ]
    # By hand: 1 x 1 x .05 / 1.05 and .3 / .9 x (.8 / 1.05) ** 2; 1024 times the time halves.
    np.testing.assert_allclose(found[0], [0.05 / 1.05, 0.3 / 0.9 * (0.8 / 1.05) ** 2])
    np.testing.assert_allclose(found[1], found[0] * [1.0, 0.5])
