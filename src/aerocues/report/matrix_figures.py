"""Figures of correlations: criteria, settings of the score, datasets, machines."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from aerocues.phrases import number_text
from aerocues.report.comparison import comparison_of
from aerocues.report.entry import ReportEntry
from aerocues.report.score_figures import COLOURS, heat_map
from aerocues.scoring.across import machines_of
from aerocues.scoring.platform_scores import PlatformScores, platform_scores

if TYPE_CHECKING:
    from matplotlib.figure import Figure

CELL = 0.42
PANEL = 2.7
CORRELATIONS = (-1.0, 1.0)


def draw_criteria(found: ReportEntry) -> Figure | None:
    """Pearson's correlation of the criteria; None for a single one."""
    names = found.ranking.scores.table.criterion_names
    if len(names) < 2:
        return None
    figure, (axes,) = _panels(1, len(names))
    _matrix(axes, names, found.validation.criteria_correlation)
    axes.set_title(f"{found.name}: Pearson's correlation of the criteria")
    return figure


def draw_sensitivity(found: ReportEntry) -> Figure:
    """Spearman's correlation of the rankings with other powers alpha and aggregations."""
    validation = found.validation
    kinds = {"power alpha": validation.alpha, "aggregation of the weights": validation.aggregation}
    figure, panels = _panels(len(kinds), max(len(each.names) for each in kinds.values()))
    for axes, (title, each) in zip(panels, kinds.items(), strict=True):
        _matrix(axes, each.names, each.correlation, digits=3)
        axes.set_title(title)
    figure.suptitle(f"{found.name}: Spearman's correlation of the rankings", fontsize=9)
    return figure


def draw_stability(entries: Sequence[ReportEntry]) -> Figure | None:
    """Spearman's correlation of the rankings of all entries; None where they share nothing."""
    comparison = comparison_of([found.entry for found in entries])
    if comparison is None:
        return None
    figure, (axes,) = _panels(1, len(comparison.names))
    _matrix(axes, comparison.names, comparison.spearman())
    axes.set_title("Spearman's correlation of the rankings")
    return figure


def draw_platforms(entries: Sequence[ReportEntry]) -> Figure | None:
    """Scores of each dataset on two machines, each normalised by itself; None without any."""
    from matplotlib.figure import Figure

    pairs = [
        (first, second, found)
        for first, second in machines_of([each.entry for each in entries])
        if isinstance(found := platform_scores(first.scores, second.scores), PlatformScores)
    ]
    if not pairs:
        return None
    columns = min(len(pairs), 2)
    rows = -(-len(pairs) // columns)
    figure = Figure(figsize=(PANEL * columns + 0.8, PANEL * rows + 0.4), layout="constrained")
    grid = figure.subplots(rows, columns, squeeze=False)
    for axes in grid.flat[len(pairs) :]:
        axes.set_visible(False)
    for axes, (first, second, found) in zip(grid.flat, pairs, strict=False):
        scores = found.combinations
        axes.plot([0, 1], [0, 1], color="#8a8a8a", lw=0.7)
        axes.plot(scores["first_score"], scores["second_score"], "o", ms=2, color=COLOURS[0])
        axes.set_xlabel(f"CUES, {first.name}")
        axes.set_ylabel(f"CUES, {second.name}")
        told = number_text(found.spearman, 4)
        axes.set_title(f"rank correlation {told}; {found.kept} of the first 10 stay")
        axes.grid()
    return figure


def _panels(count: int, names: int) -> tuple[Figure, Any]:
    from matplotlib.figure import Figure

    side = CELL * names + 1.6
    figure = Figure(figsize=(side * count, side), layout="constrained")
    return figure, figure.subplots(1, count, squeeze=False)[0]


def _matrix(axes: Any, names: Sequence[str], values: NDArray[np.float64], digits: int = 2) -> None:
    # The limits are the same everywhere, so that colours can be compared between figures.
    heat_map(axes, np.asarray(values), CORRELATIONS, digits)
    axes.set_xticks(range(len(names)), names, rotation=90)
    axes.set_yticks(range(len(names)), names)
