"""Figures of the quality of matches: from pair to pair, against each other, against the truth."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from aerocues.report.curves import curves_of
from aerocues.report.interactive.drawing import SYMBOLS, dots, framed, line, matrix
from aerocues.report.interactive.view import QUALITY, Array, View, label_of
from aerocues.report.score_figures import COLOURS

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

FEWEST_TO_CORRELATE = 3
PANELS_A_ROW = 3


def distributions(view: View) -> Figure | str:
    """A violin a combination: how a figure varies from pair to pair."""
    from plotly.graph_objects import Violin

    column = view.column or view.first_known(*QUALITY)
    values = view.values(column) if column else None
    if column is None or values is None:
        return "no figure of pairs was measured"
    names = [f"{pair['image_1']} {pair['image_2']}" for pair in view.pairs]
    traces = [
        Violin(
            x=values[position],
            y=[view.names[position]] * len(names),
            text=names,
            orientation="h",
            points="all",
            pointpos=0,
            box_visible=True,
            line_color=COLOURS[0],
            marker={"size": 4, "opacity": 0.65},
            hovertemplate="%{y}<br>%{text}<br>%{x:.4g}<extra></extra>",
        )
        for position in view.best
    ]
    return framed(
        view.found.name,
        traces,
        rows=2 * len(traces),
        xaxis_title=label_of(column),
        showlegend=False,
        violinmode="overlay",
    )


def precision_recall(view: View) -> Figure | str:
    """Means of precision and recall, one dot a combination."""
    suffix = "_beyond_chance" if view.has("recall_beyond_chance") else ""
    recall, precision = f"recall{suffix}", f"precision{suffix}"
    traces = dots(view, view.means(recall), view.means(precision), by=1)
    if not traces:
        return "precision and recall were not measured"
    axes: dict[str, Any] = {"xaxis_title": label_of(recall), "yaxis_title": label_of(precision)}
    return framed(view.found.name, traces, **axes)


def inliers_matches(view: View) -> Figure | str:
    """Means of inliers and matches; on the dotted lines all, and one in ten, are inliers."""
    x, y = view.means("matches"), view.means("inliers")
    known = x[view.positions][np.isfinite(x[view.positions])]
    if not len(known):
        return "inliers and matches were not measured"
    ends = [float(max(known.min(), 1.0)), float(known.max())]
    behind = [line(ends, [share * end for end in ends]) for share in (1.0, 0.1)]
    traces = dots(view, x, y, by=0, log=True, behind=behind)
    axes: dict[str, Any] = {
        "xaxis": {"title": "matches", "type": "log"},
        "yaxis": {"title": "inliers", "type": "log"},
    }
    return framed(view.found.name, traces, **axes) if traces else "no combination has inliers"


def curves(view: View) -> Figure | str:
    """A figure of pairs along each graded transformation, one line a combination."""
    from plotly.graph_objects import Scatter
    from plotly.subplots import make_subplots

    found = curves_of(view.found.entry.dataset, view.pairs)
    column = view.column or view.first_known(*QUALITY)
    values = view.values(column) if column else None
    if not found or column is None or values is None:
        return "these images are not a graded series"
    rows = -(-len(found) // PANELS_A_ROW)
    figure = make_subplots(
        rows=rows, cols=min(PANELS_A_ROW, len(found)), subplot_titles=[c["name"] for c in found]
    )
    for number, curve in enumerate(found):
        place = {"row": number // PANELS_A_ROW + 1, "col": number % PANELS_A_ROW + 1}
        for rank, position in enumerate(view.best):
            x, y = _means_along(curve["x"], values[position, curve["pairs"]])
            trace = Scatter(
                x=x,
                y=y,
                name=view.names[position],
                legendgroup=view.names[position],
                showlegend=number == 0,
                mode="lines+markers",
                line_color=COLOURS[rank % len(COLOURS)],
                marker_symbol=SYMBOLS[rank % len(SYMBOLS)],
                hovertemplate=f"{view.names[position]}<br>%{{x}}: %{{y:.3g}}<extra></extra>",
            )
            figure.add_trace(trace, **place)
        figure.update_xaxes(title_text=curve["axis"], **place)
    figure.update_yaxes(rangemode="tozero")
    figure.update_layout(
        title=f"{view.found.name}: {label_of(column)}",
        template="plotly_white",
        height=120 + 240 * rows,
    )
    return figure


def _means_along(steps: list[float], values: Array) -> tuple[list[float], list[float]]:
    """Means of the pairs at the same place; a gap where one failed."""
    places = sorted(set(steps))
    at = np.array(steps)
    return places, [float(values[at == place].mean()) for place in places]


def ground_truth(view: View) -> Figure | str:
    """What inliers say against the truth; on the dotted line both agree. Failures count as 0."""
    truth = view.first_known("gt_precision@3", *view.known("gt_"))
    guess = view.first_known("ref_precision@3", "precision_beyond_chance", "precision")
    if truth is None or guess is None:
        return "these images have no ground truth"
    x, y = (view.means(name, failed_as_zero=True) for name in (guess, truth))
    traces = dots(view, x, y, by=1, behind=[line([0, 1], [0, 1])])
    axes: dict[str, Any] = {"xaxis_title": label_of(guess), "yaxis_title": label_of(truth)}
    return framed(view.found.name, traces, **axes)


def ground_truth_correlations(view: View) -> Figure | str:
    """Spearman's correlation of each figure without ground truth with each one of it."""
    from aerocues.scoring.correlation import rank_correlation

    truths = [*view.known("gt_"), *view.known("auc@")]
    others = [name for name in view.known("") if name not in truths and "seconds" not in name]
    if not truths:
        return "these images have no ground truth"
    if len(view.positions) < FEWEST_TO_CORRELATE:
        return "a correlation needs at least three combinations"
    means = np.array(
        [view.means(name, failed_as_zero=True)[view.positions] for name in (*truths, *others)]
    )
    correlation = rank_correlation(means)[len(truths) :, : len(truths)]
    return matrix(view.found.name, truths, others, correlation, "Spearman")
