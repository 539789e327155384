"""Settings of a score and their presets."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from aerocues.errors import ScoreError
from aerocues.scoring import SCORE_PRESETS, ScoreSettings, criteria_named
from aerocues.scoring.settings import score_preset_named


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"alpha": 0}, r"alpha .*\b0\b"),
        ({"alpha": -1.0}, r"alpha .*-1\.0"),
        ({"alpha": float("nan")}, "alpha .*nan"),
        ({"alpha": float("inf")}, "alpha .*inf"),
        ({"weights": ()}, "weights.* entropy"),
        ({"weights": ("merec",)}, "'merec'.* entropy"),
        ({"weights": ("pca", "pca")}, "pca"),
        ({"aggregation": "median"}, "'median'.* arithmetic"),
        ({"failures": "ignore"}, "'ignore'.* worst, omit"),
        ({"bounds": "none"}, "'none'.* measured, positive, zero"),
    ],
)
def test_settings_that_do_not_exist(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ScoreError, match=message):
        replace(ScoreSettings(), **changes)


@pytest.mark.parametrize("name", SCORE_PRESETS)
def test_presets_name_criteria_that_exist(name: str) -> None:
    preset = score_preset_named(name)
    assert preset.name == name
    pairs = criteria_named(preset.criteria)
    assert not any(criterion.reconstruction for criterion in pairs)
    assert all(each.reconstruction for each in criteria_named(preset.reconstruction_criteria))
    assert len(preset.settings.weights) == 4


def test_preset_of_the_thesis_is_as_published() -> None:
    settings = score_preset_named("thesis").settings
    assert settings.failures == "omit"
    assert settings.alpha == 0.5
    assert settings.aggregation == "arithmetic"
    assert settings.weights == ("entropy", "variance", "critic_published", "pca")


def test_an_unknown_preset() -> None:
    with pytest.raises(ScoreError, match="default, models, inliers, thesis"):
        score_preset_named("best")
