"""Figures of 3D models for a paper: quality of each model, and its relation to the matches."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from aerocues.report.entry import ReportEntry
from aerocues.report.score_figures import COLOURS, LINE, TOP, WIDTH
from aerocues.results.combination_columns import combination_name, name_in_row
from aerocues.results.model_quality import model_order

if TYPE_CHECKING:
    from matplotlib.figure import Figure

OK = "ok"
FIGURE_OF_PAIRS = ("excess_inliers", "inliers")
MARKERS = {OK: ("o", COLOURS[0], "success"), "": ("x", COLOURS[5], "failed")}


def ordered_models(found: ReportEntry) -> list[dict[str, Any]]:
    """Reconstructions sorted from best to worst, with combination names."""
    rows = [{**row, "name": name_in_row(row)} for row in found.models.to_dicts()]
    return sorted(rows, key=lambda row: (model_order(row), row["name"]))


def draw_models(found: ReportEntry) -> Figure | None:
    """Registered images and 3D points of the best models; None if there are no models."""
    from matplotlib.figure import Figure

    rows = ordered_models(found)[:TOP]
    if not rows:
        return None
    figure = Figure(figsize=(WIDTH, 1.0 + LINE * 1.2 * len(rows)))
    images, points = figure.subplots(1, 2, sharey=True)
    colours = [COLOURS[0] if row["status"] == OK else "#b5b5b5" for row in rows]
    places = range(len(rows))
    images.barh(places, [row["registered_images"] or 0 for row in rows], 0.72, color=colours)
    points.barh(places, [row["points_3d"] or 0 for row in rows], 0.72, color=colours)
    images.set_yticks(places, [row["name"] for row in rows])
    images.set_ylim(len(rows) - 0.5, -0.5)
    whole = max((row["images"] or 0 for row in rows), default=0)
    if whole:
        images.axvline(whole, color="#666666", lw=0.7, ls=":")
    images.set_xlabel("registered images")
    points.set_xlabel("3D points")
    for axes in (images, points):
        axes.grid(axis="x")
    figure.suptitle(f"{found.name}: models (gray: failed)", fontsize=9)
    figure.tight_layout()
    return figure


def draw_relation(found: ReportEntry) -> Figure | None:
    """Inliers of pairs against 3D points, one dot per combination; None without models."""
    from matplotlib.figure import Figure

    known = [row for row in ordered_models(found) if row["points_3d"] is not None]
    column, means = means_of_pairs(found)
    known = [row for row in known if np.isfinite(means.get(row["name"], np.nan))]
    if not known:
        return None
    figure = Figure(figsize=(WIDTH, 4.2))
    axes = figure.subplots()
    for wanted, (marker, colour, label) in MARKERS.items():
        own = [row for row in known if (row["status"] == OK) == (wanted == OK)]
        if own:
            axes.plot(
                [means[row["name"]] for row in own],
                [row["points_3d"] for row in own],
                marker,
                ms=4,
                color=colour,
                label=label,
            )
    axes.grid()
    axes.set_xlabel(f"mean of {column.replace('_', ' ')} over the pairs of images")
    axes.set_ylabel("3D points")
    axes.legend(loc="best")
    axes.set_title(found.name)
    return figure


def means_of_pairs(found: ReportEntry) -> tuple[str, dict[str, float]]:
    """Mean inliers over the successful pairs, beyond chance if that was measured."""
    import polars as pl

    rows = found.rows
    column = next(
        (name for name in FIGURE_OF_PAIRS if rows[name].is_not_null().any()), FIGURE_OF_PAIRS[-1]
    )
    name = combination_name()
    succeeded = rows.filter(pl.col("status").is_in(found.succeeded))
    means = succeeded.group_by(name).agg(pl.col(column).mean()).drop_nulls()
    return column, dict(means.iter_rows())
