"""Scores any table of alternatives x criteria x repeats, with the uncertainty of the scores."""

from __future__ import annotations

from aerocues.scoring.criteria import CRITERIA, Criterion, criteria_named
from aerocues.scoring.cues import Scores, score
from aerocues.scoring.ranking import Ranking, rank_alternatives
from aerocues.scoring.settings import SCORE_PRESETS, ScoreSettings
from aerocues.scoring.table import DecisionTable

__all__ = [
    "CRITERIA",
    "SCORE_PRESETS",
    "Criterion",
    "DecisionTable",
    "Ranking",
    "ScoreSettings",
    "Scores",
    "criteria_named",
    "rank_alternatives",
    "score",
]
