"""Scores by each preset that the measurements suffice for."""

from __future__ import annotations

import pytest

import aerocues
from aerocues import Results
from aerocues.report.preset_scores import preset_scores
from aerocues.report.report import report_entries


def test_scores_are_those_of_the_presets(flight: Results) -> None:
    (found,) = report_entries([flight], resamples=20)
    scores = preset_scores(found)
    # Without references the presets that need them are left out.
    assert set(scores) == {"thesis", "inliers"}
    ranked = aerocues.score(flight, preset="thesis", resamples=20).frame("combination")
    expected = dict(ranked.select("combination", "score").iter_rows())
    assert dict(zip(found.combinations, scores["thesis"], strict=True)) == pytest.approx(expected)
