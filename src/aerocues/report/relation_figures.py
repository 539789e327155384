"""Figures of the time of combinations and of their differences."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from aerocues.report.entry import ReportEntry
from aerocues.report.score_figures import COLOURS, LINE, TOP, WIDTH
from aerocues.results.medians import combination_medians
from aerocues.scoring.cues import Scores
from aerocues.scoring.pareto import pareto_front

if TYPE_CHECKING:
    from matplotlib.figure import Figure

STAGES = ("detect", "describe", "match", "verify")
HATCHES = ("", "////", "....", "xxxx")
LABELLED = 12


def draw_pareto(found: ReportEntry) -> Figure | None:
    """Time against quality, with the Pareto front.

    Times are medians over all pairs; failed pairs count for the quality as in the score.
    """
    from matplotlib.figure import Figure
    from matplotlib.ticker import StrMethodFormatter

    validation, scores = found.validation, found.ranking.scores
    if not validation.pareto_criteria:
        return None
    criterion, seconds = validation.pareto_criteria[1], found.seconds()
    quality = quality_as_scored(scores, criterion)
    speed = np.array([seconds.get(name, np.nan) for name in found.combinations])
    if np.isnan(speed).all():
        return None
    front = np.flatnonzero(pareto_front(np.column_stack([-speed, quality])))
    front = front[np.argsort(speed[front], kind="stable")]
    figure = Figure(figsize=(WIDTH, 4.4))
    axes = figure.subplots()
    axes.plot(speed, quality, "o", ms=2.5, color="#8a8a8a", label="combinations")
    axes.step(speed[front], quality[front], where="post", color=COLOURS[5], lw=1)
    axes.plot(speed[front], quality[front], "D", ms=4, color=COLOURS[5], label="Pareto front")
    if np.nanmin(speed) > 0:
        axes.set_xscale("log")
        axes.xaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    for number, position in enumerate(front[:LABELLED], start=1):
        place = (speed[position], quality[position])
        beside = (3, -9) if number % 2 else (-7, 4)
        axes.annotate(str(number), place, xytext=beside, textcoords="offset points", fontsize=7)
    listed = "\n".join(
        f"{number}  {found.combinations[position]}"
        for number, position in enumerate(front[:LABELLED], start=1)
    )
    axes.text(1.02, 1.0, listed, transform=axes.transAxes, va="top", fontsize=7, linespacing=1.5)
    axes.grid()
    counted = " (failed pairs count as the worst)" if scores.settings.failures == "worst" else ""
    axes.set_xlabel("median seconds for one image (detect, describe) and one pair (match, verify)")
    axes.set_ylabel(criterion.replace("_", " ") + counted)
    axes.legend(loc="best")
    axes.set_title(found.name)
    return figure


def quality_as_scored(scores: Scores, criterion: str) -> NDArray[np.float64]:
    """(combinations,) means of a criterion in its unit, with failures as in the score."""
    column = scores.table.criterion_names.index(criterion)
    values = scores.table.values[:, :, column]
    low, high = np.nanmin(values), np.nanmax(values)
    share = scores.normalised[:, column] ** (1 / scores.settings.alpha) * (high - low)
    return np.asarray(high - share if scores.table.is_cost[column] else low + share)


def draw_times(found: ReportEntry) -> Figure | None:
    """Stacked median times of the stages for the best combinations; None if not measured."""
    from matplotlib.figure import Figure

    best = found.ranking.frame("combination")["combination"].to_list()[:TOP]
    medians = {row["combination"]: row for row in combination_medians(found.rows).to_dicts()}
    times = np.array(
        [[medians[name][f"{stage}_seconds"] or 0.0 for stage in STAGES] for name in best]
    )
    if not times.any():
        return None
    figure = Figure(figsize=(WIDTH, 1.0 + LINE * 1.2 * len(best)))
    axes = figure.subplots()
    before = np.zeros(len(best))
    for column, stage in enumerate(STAGES):
        axes.barh(
            range(len(best)),
            times[:, column],
            0.72,
            left=before,
            color=COLOURS[column],
            hatch=HATCHES[column],
            edgecolor="white",
            linewidth=0.3,
            label=stage,
        )
        before += times[:, column]
    axes.set_yticks(range(len(best)), best)
    axes.set_ylim(len(best) - 0.5, -0.5)
    axes.grid(axis="x")
    axes.set_xlabel(
        f"{found.name}: median seconds, one image (detect, describe) and one pair (match, verify)"
    )
    axes.legend(ncols=len(STAGES), loc="lower center", bbox_to_anchor=(0.4, 1.0))
    return figure


def draw_critical_difference(found: ReportEntry) -> Figure | None:
    """Mean ranks of the best; bars join groups without significant difference (Demsar 2006)."""
    from matplotlib.figure import Figure

    compared = found.validation.critical_difference
    if isinstance(compared, str):
        return None
    ranks, number = compared.mean_ranks, len(compared.alternatives)
    left = -(-number // 2)
    bars = 0.32 * len(compared.groups)
    figure = Figure(figsize=(WIDTH, 1.1 + 0.22 * left + 0.25 * bars))
    axes = figure.subplots()
    low, high = float(np.floor(ranks.min())), float(np.ceil(ranks.max()))
    high = max(high, low + 1, low + compared.critical_difference)
    first_label = 0.9 + bars
    axes.set_xlim(low, high)
    axes.set_ylim(first_label + 0.75 * left, -1.2)
    axes.spines[["left", "bottom"]].set_visible(False)
    axes.spines["top"].set_visible(True)
    axes.spines["top"].set_position(("data", 0))
    axes.xaxis.set_ticks_position("top")
    axes.xaxis.set_label_position("top")
    axes.set_yticks([])
    _label_ranks(axes, compared, first_label, left)
    for level, (first, last) in enumerate(compared.groups):
        height = 0.45 + 0.32 * level
        axes.plot([ranks[first], ranks[last]], [height] * 2, color="black", lw=2.5)
    axes.plot([low, low + compared.critical_difference], [-0.95] * 2, "|-", color=COLOURS[5])
    told = f"critical difference {compared.critical_difference:.2f}"
    axes.text(low, -1.2, told, va="bottom", fontsize=7)
    axes.set_xlabel(
        f"{found.name}: mean rank over {compared.units} pairs or sequences", labelpad=26
    )
    return figure


def _label_ranks(axes: Any, compared: Any, first_label: float, left: int) -> None:
    """Names on both sides, with lines to their mean ranks."""
    number = len(compared.alternatives)
    for position, (name, rank) in enumerate(
        zip(compared.alternatives, compared.mean_ranks, strict=True)
    ):
        on_left = position < left
        step = position if on_left else number - 1 - position
        height = first_label + 0.75 * step
        edge = 0.0 if on_left else 1.0
        transform = axes.get_yaxis_transform()
        axes.plot([rank, rank], [0, height], color="#666666", lw=0.7)
        axes.annotate(
            f"{name} ({rank:.2f})",
            (rank, height),
            xytext=(edge, height),
            xycoords="data",
            textcoords=transform,
            ha="right" if on_left else "left",
            va="center",
            fontsize=7.5,
            arrowprops={"arrowstyle": "-", "color": "#666666", "lw": 0.7, "shrinkB": 0},
        )
