"""Figures of the scores: dots with intervals, heat maps, weights."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from aerocues.report.entry import ReportEntry

if TYPE_CHECKING:
    from matplotlib.figure import Figure

TOP = 20
# Okabe and Ito, "Color universal design" (2008): distinct for every kind of colour vision.
COLOURS = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00", "#F0E442", "#000000")
WIDTH = 7.0
LINE = 0.17
CELL = 0.28
LEAST_CONTRAST = 0.55


def draw_scores(found: ReportEntry) -> Figure:
    """CUES of the best with 95 % intervals; filled: not significantly different from the best.

    Crosses could not be compared with the best: they share too few pairs with it.
    """
    from matplotlib.figure import Figure

    frame = found.ranking.frame("combination").head(TOP)
    alike = {*found.ranking.indistinguishable(), frame["combination"][0]}
    untested = set(found.ranking.untested())
    figure = Figure(figsize=(WIDTH * 0.75, 0.9 + LINE * len(frame)))
    axes = figure.subplots()
    for position, row in enumerate(frame.iter_rows(named=True)):
        if row["score_low"] is not None:
            axes.plot(
                [row["score_low"], row["score_high"]], [position] * 2, color=COLOURS[0], lw=1.2
            )
        face = COLOURS[0] if row["combination"] in alike else "white"
        marker = "x" if row["combination"] in untested else "o"
        axes.plot(row["score"], position, marker, ms=4.5, color=COLOURS[0], markerfacecolor=face)
    axes.set_yticks(range(len(frame)), frame["combination"].to_list())
    axes.set_ylim(len(frame) - 0.5, -0.5)
    axes.grid(axis="x")
    crosses = "; cross: not compared" if untested.intersection(frame["combination"]) else ""
    axes.set_xlabel(
        f"CUES, 95 % interval (filled: not significantly different from the best{crosses})"
    )
    axes.set_title(_title(found))
    return figure


def _title(found: ReportEntry) -> str:
    table = found.ranking.scores.table
    return f"{found.name}: {len(table.alternatives):,} combinations, {len(table.repeats):,} pairs"


def draw_heat_maps(found: ReportEntry) -> Figure:
    """CUES by detector and descriptor, one panel per norm and matcher; hatched: no score."""
    from matplotlib.figure import Figure

    parts = [name.split("-") for name in found.combinations]
    detectors, descriptors = (sorted({part[column] for part in parts}) for column in (0, 1))
    panels = sorted({(part[2], part[3]) for part in parts})
    scores = found.ranking.scores.scores
    figure = Figure(
        figsize=(
            1.6 + CELL * len(descriptors) * min(2, len(panels)) + 0.8,
            1.4 + (CELL * 0.8 * len(detectors) + 0.8) * -(-len(panels) // 2),
        ),
        layout="constrained",
    )
    grid = figure.subplots(-(-len(panels) // 2), min(2, len(panels)), squeeze=False)
    limits = (float(np.nanmin(scores)), float(np.nanmax(scores)))
    for axes in grid.flat[len(panels) :]:
        axes.set_visible(False)
    image = None
    for axes, panel in zip(grid.flat, panels, strict=False):
        matrix = np.full((len(detectors), len(descriptors)), np.nan)
        for part, score in zip(parts, scores, strict=True):
            if (part[2], part[3]) == panel:
                matrix[detectors.index(part[0]), descriptors.index(part[1])] = score
        image = heat_map(axes, matrix, limits)
        axes.set_xticks(range(len(descriptors)), descriptors, rotation=90)
        axes.set_yticks(range(len(detectors)), detectors)
        axes.set_title(" ".join(panel))
    if image is not None:
        figure.colorbar(image, ax=grid, label="CUES", shrink=0.6)
    figure.suptitle(f"{_title(found)} (hatched: incompatible or not measured)", fontsize=9)
    return figure


def heat_map(axes: Any, matrix: Any, limits: tuple[float, float], digits: int = 2) -> Any:
    """Draw a matrix with its values in the cells; what is NaN stays hatched."""
    rows, columns = matrix.shape
    axes.patch.set(hatch="////", edgecolor="#bbbbbb", facecolor="white")
    image = axes.imshow(matrix, cmap="cividis", vmin=limits[0], vmax=limits[1], aspect="auto")
    middle = limits[0] + LEAST_CONTRAST * (limits[1] - limits[0])
    for row, column in zip(*np.nonzero(~np.isnan(matrix)), strict=True):
        value = matrix[row, column]
        ink = "white" if value < middle else "black"
        text = f"{value:.{digits}f}".removeprefix("0")
        axes.text(column, row, text, ha="center", va="center", fontsize=5.5, color=ink)
    axes.set_xticks(np.arange(columns + 1) - 0.5, minor=True)
    axes.set_yticks(np.arange(rows + 1) - 0.5, minor=True)
    axes.grid(which="minor", color="white", linewidth=0.8)
    axes.tick_params(which="both", length=0)
    return image


def draw_weights(found: ReportEntry) -> Figure:
    """Weights of the criteria by each method, and their aggregate."""
    from matplotlib.figure import Figure

    frame = found.ranking.weights()
    methods = frame.columns[1:]
    criteria = frame["criterion"].to_list()
    figure = Figure(figsize=(WIDTH, 0.9 + 0.4 * len(criteria)))
    axes = figure.subplots()
    height = 0.8 / len(methods)
    for number, method in enumerate(methods):
        colour = "black" if method == "aggregate" else COLOURS[number % len(COLOURS)]
        places = np.arange(len(criteria)) + (number - (len(methods) - 1) / 2) * height
        axes.barh(places, frame[method].to_numpy(), height, color=colour, label=method)
    axes.set_yticks(range(len(criteria)), criteria)
    axes.set_ylim(len(criteria) - 0.5, -0.5)
    axes.grid(axis="x")
    axes.set_xlabel(f"{found.name}: weight")
    axes.legend(ncols=len(methods), loc="lower center", bbox_to_anchor=(0.4, 1.0))
    return figure
