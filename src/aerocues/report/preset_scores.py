"""The scores of all combinations by each preset, to compare them with the ground truth."""

from __future__ import annotations

from typing import TYPE_CHECKING

from aerocues.errors import ScoreError
from aerocues.scoring.cues import score
from aerocues.scoring.measured import MeasuredRows, table_of
from aerocues.scoring.settings import REPRODUCING, SCORE_PRESETS

if TYPE_CHECKING:
    from aerocues.report.entry import ReportEntry


def preset_scores(found: ReportEntry) -> dict[str, list[float | None]]:
    """One value per combination for each preset of scoring that the measurements suffice for."""
    measured = MeasuredRows(found.rows, found.models)
    scores = {}
    for preset in SCORE_PRESETS.values():
        if preset.name == REPRODUCING:  # nobody is to choose by it
            continue
        try:
            table = table_of(measured, preset.name, reconstruction=False).table
            by_name = score(table, preset.settings)
        except ScoreError:  # its criteria were not measured: it is not among the presets to compare
            continue
        known = dict(zip(table.alternatives, by_name.scores.tolist(), strict=True))
        scores[preset.name] = [known.get(name) for name in found.combinations]
    return scores
