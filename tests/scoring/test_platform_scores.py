"""Scores of one dataset on two machines, and the price of matchers, by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from aerocues.scoring import ScoreSettings, criteria_named, score
from aerocues.scoring.cues import Scores
from aerocues.scoring.matcher_times import matcher_times
from aerocues.scoring.platform_scores import PlatformScores, platform_scores
from tests.scoring.tables import table_of


def scored(values: list[float]) -> Scores:
    names = [f"a{number}" for number in range(len(values))]
    table = table_of(np.array(values).reshape(-1, 1, 1), names=names)
    table = replace(table, components={"kind": tuple("aab"[: len(values)])})
    return score(table, ScoreSettings(alpha=1))


def test_differences_by_combination_and_component() -> None:
    found = platform_scores(scored([1.0, 0.5, 0.0]), scored([1.0, 0.25, 0.0]))
    assert isinstance(found, PlatformScores)
    assert found.combinations.rows() == [
        ("a0", 1.0, 1.0, 0.0, 1.0, 1.0),
        ("a1", 0.5, 0.25, -0.25, 2.0, 2.0),
        ("a2", 0.0, 0.0, 0.0, 3.0, 3.0),
    ]
    assert found.components["kind"].rows() == [("a", 0.75, 0.625, -0.125, 2), ("b", 0, 0, 0, 1)]
    assert (found.kept, found.largest) == (3, 0.25)
    assert found.spearman == pytest.approx(1)


def test_matchers_are_compared_over_the_same_methods() -> None:
    names = ["A-X-L2-BF", "A-X-L2-FLANN", "A-Y-L2-BF", "A-Y-L2-FLANN", "B-X-L2-FLANN"]
    parts = [name.split("-") for name in names]
    table = table_of(np.array([1.0, 2.0, 3.0, 24.0, 7.0]).reshape(-1, 1, 1), names=names)
    table = replace(
        table,
        criteria=tuple(criteria_named(["seconds_per_1k_inliers"])),
        components={
            kind: tuple(part[column] for part in parts)
            for column, kind in enumerate(("detectors", "descriptors", "norms", "matchers"))
        },
    )
    found = matcher_times(score(table), "seconds_per_1k_inliers")
    # What was not measured with brute force takes no part.
    ((name, matcher, number, brute_force, other, ratio),) = found["detectors"].rows()
    assert (name, matcher, number, brute_force, other) == ("A", "FLANN", 2, 2.0, 13.0)
    assert ratio == pytest.approx((2 * 8) ** 0.5)
    assert found["descriptors"].select("name", "ratio").rows() == [
        ("X", pytest.approx(2)),
        ("Y", pytest.approx(8)),
    ]
    assert matcher_times(score(table), "inliers") == {}
