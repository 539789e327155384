"""Figures of 3D models: what became of each, what pairs say of it, its cloud."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from aerocues.errors import ScoreError
from aerocues.report.interactive.drawing import framed, matrix
from aerocues.report.interactive.view import View, label_of
from aerocues.report.model_figures import OK, means_of_pairs, ordered_models
from aerocues.report.score_figures import COLOURS

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

NO_MODELS = "there are no models; make some with `aerocues.reconstruct`"
FAILED = "#b5b5b5"
MOST_POINTS = 40_000
DISTANCES = ("cloud_distance_rms", "reference_distance_rms")


def _rows(view: View) -> list[dict[str, object]]:
    shown = set(view.named(view.positions))
    return [row for row in ordered_models(view.found) if row["name"] in shown]


def models(view: View) -> Figure | str:
    """Registered images and 3D points of each model, the best first; gray: failed."""
    from plotly.graph_objects import Bar
    from plotly.subplots import make_subplots

    rows = _rows(view)[: view.top]
    if not rows:
        return NO_MODELS
    names = [row["name"] for row in rows]
    colours = [COLOURS[0] if row["status"] == OK else FAILED for row in rows]
    titles = ("registered images", "3D points")
    figure = make_subplots(rows=1, cols=2, shared_yaxes=True, subplot_titles=titles)
    for column, key in enumerate(("registered_images", "points_3d"), start=1):
        values = [row[key] or 0 for row in rows]
        bar = Bar(x=values, y=names, orientation="h", marker_color=colours, showlegend=False)
        figure.add_trace(bar, row=1, col=column)
    figure.update_yaxes(autorange="reversed")
    figure.update_layout(
        title=view.found.name, template="plotly_white", height=160 + 24 * len(rows)
    )
    return figure


def models_relation(view: View) -> Figure | str:
    """Mean inliers of pairs against 3D points, one dot a combination."""
    from plotly.graph_objects import Scatter

    column, means = means_of_pairs(view.found)
    known = [
        row for row in _rows(view) if row["points_3d"] is not None and str(row["name"]) in means
    ]
    if not known:
        return NO_MODELS
    traces = []
    for succeeded, name, symbol in ((True, "success", "circle"), (False, "failed", "x")):
        own = [row for row in known if (row["status"] == OK) == succeeded]
        marker = {"color": COLOURS[0 if succeeded else 5], "symbol": symbol, "size": 8}
        traces.append(
            Scatter(
                x=[means[str(row["name"])] for row in own],
                y=[row["points_3d"] for row in own],
                text=[row["name"] for row in own],
                mode="markers",
                name=name,
                marker=marker,
                hovertemplate="%{text}<br>%{x:.4g}, %{y:,}<extra></extra>",
            )
        )
    axes: dict[str, Any] = {
        "xaxis_title": f"mean {label_of(column)} of a pair",
        "yaxis_title": "3D points",
    }
    return framed(view.found.name, traces, **axes)


def outcomes(view: View) -> Figure | str:
    """Spearman's correlation of figures of pairs with figures of models."""
    from aerocues.scoring.outcomes import relations_of

    try:
        found = relations_of(
            view.found.rows, view.found.models, chance_fails=view.found.chance_fails
        )
    except ScoreError as error:
        return str(error)
    return matrix(view.found.name, found.outcomes, found.features, found.spearman, "Spearman")


def cloud_distances(view: View) -> Figure | str:
    """Root mean square distances between each cloud and that of the reference, both ways."""
    from plotly.graph_objects import Bar

    rows = [row for row in _rows(view) if row[DISTANCES[0]] is not None][: view.top]
    if not rows:
        return NO_MODELS
    names = [row["name"] for row in rows]
    traces = [
        Bar(
            x=[row[key] for row in rows],
            y=names,
            orientation="h",
            name=label_of(key),
            marker_color=COLOURS[number],
        )
        for number, key in enumerate(DISTANCES)
    ]
    unit = rows[0]["length_unit"]
    axis = f"{unit}; reference {rows[0]['reference']}"
    return framed(view.found.name, traces, rows=2 * len(rows), xaxis_title=axis)


def cloud(view: View) -> Figure | str:
    """The point cloud and the cameras of the best model among the combinations."""
    from plotly.graph_objects import Scatter3d

    for row in _rows(view):
        found = view.found.results.cloud(str(row["row_key"])) if row["points_3d"] else None
        if found is not None:
            break
    else:
        return NO_MODELS
    rng = np.random.default_rng(0)
    count = min(len(found.points), MOST_POINTS)
    kept = np.sort(rng.choice(len(found.points), count, replace=False))
    colours = [f"rgb({r},{g},{b})" for r, g, b in found.colours[kept].tolist()]
    points = Scatter3d(
        **_columns(found.points[kept]),
        mode="markers",
        name=f"{count:,} points",
        marker={"size": 1.5, "color": colours},
        hoverinfo="skip",
    )
    cameras = Scatter3d(
        **_columns(found.centres),
        mode="markers",
        name="cameras",
        text=found.names.tolist(),
        marker={"size": 4, "color": COLOURS[5], "symbol": "diamond"},
        hovertemplate="%{text}<extra></extra>",
    )
    return framed(
        f"{view.found.name}: {row['name']}", [points, cameras], scene_aspectmode="data", height=700
    )


def _columns(points: np.ndarray) -> dict[str, np.ndarray]:
    return {axis: points[:, number] for number, axis in enumerate("xyz")}
