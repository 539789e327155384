"""Figures of how far a ranking can be trusted, and of rankings side by side."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from aerocues.report.comparison import comparison_of
from aerocues.report.interactive.drawing import SYMBOLS, framed, matrix
from aerocues.report.interactive.view import View
from aerocues.report.score_figures import COLOURS

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

ONE_RANKING = "there is one ranking only; give several results to compare"


def criteria(view: View) -> Figure:
    """Pearson's correlation of the criteria over the combinations."""
    names = view.found.ranking.scores.table.criterion_names
    values = view.found.validation.criteria_correlation
    return matrix(view.found.name, names, names, values, "Pearson")


def sensitivity(view: View) -> Figure:
    """Spearman's correlation of the ranking with those under other settings."""
    from plotly.graph_objects import Scatter

    validation, traces = view.found.validation, []
    settings = view.found.ranking.scores.settings
    for number, (title, found, scored) in enumerate(
        (
            ("power alpha", validation.alpha, f"{settings.alpha:g}"),
            ("aggregation", validation.aggregation, settings.aggregation),
            ("criterion left out", validation.criterion_left_out, ""),
        )
    ):
        as_scored = found.names.index(scored) if scored in found.names else 0
        traces.append(
            Scatter(
                x=found.correlation[as_scored],
                y=[f"{title}: {name}" for name in found.names],
                text=list(found.best),
                mode="markers",
                name=title,
                marker={"color": COLOURS[number], "symbol": SYMBOLS[number], "size": 9},
                hovertemplate="%{y}<br>%{x:.3f}<br>best: %{text}<extra></extra>",
            )
        )
    rows = sum(len(trace.y) for trace in traces)
    axis = "Spearman's correlation with the ranking as it is scored"
    return framed(view.found.name, traces, rows=rows, xaxis_title=axis)


def agreement(view: View) -> Figure | str:
    """Spearman's correlation of CUES with other methods of decision."""
    found = view.found.validation.agreement
    if isinstance(found, str):
        return found
    return matrix(view.found.name, found.names, found.names, found.correlation, "Spearman")


def critical_difference(view: View) -> Figure | str:
    """Mean ranks of the best; lines join those that cannot be told apart (Demsar 2006)."""
    from plotly.graph_objects import Scatter

    compared = view.found.validation.critical_difference
    if isinstance(compared, str):
        return compared
    names = list(compared.alternatives)
    edge, step = compared.mean_ranks.max(), 0.02 * np.ptp(compared.mean_ranks)
    traces = [
        Scatter(
            x=[edge + (level + 2) * step] * 2,
            y=[names[first], names[last]],
            mode="lines",
            line={"color": "black", "width": 3},
            hoverinfo="skip",
            showlegend=False,
        )
        for level, (first, last) in enumerate(compared.groups)
    ]
    hover = "%{y}<br>mean rank %{x:.2f}<extra></extra>"
    marker = {"color": COLOURS[0], "size": 9}
    traces.append(
        Scatter(
            x=compared.mean_ranks,
            y=names,
            mode="markers",
            marker=marker,
            hovertemplate=hover,
            showlegend=False,
        )
    )
    axis = f"mean rank; critical difference {compared.critical_difference:.2f}"
    return framed(view.found.name, traces, rows=len(names), xaxis_title=axis)


def rankings(view: View) -> Figure | str:
    """Spearman's correlation of the rankings of datasets and machines."""
    compared = comparison_of([found.entry for found in view.entries])
    if compared is None:
        return ONE_RANKING
    names = list(compared.names)
    return matrix("Agreement of the rankings", names, names, compared.spearman(), "Spearman")


def ranks(view: View) -> Figure | str:
    """Ranks of the most versatile combinations on each dataset, one line each."""
    from plotly.graph_objects import Scatter

    compared = comparison_of([found.entry for found in view.entries])
    if compared is None:
        return ONE_RANKING
    frame = compared.versatility().head(view.top)
    traces = [
        Scatter(
            x=list(compared.names),
            y=[row[f"rank_{name}"] for name in compared.names],
            mode="lines+markers",
            name=row["alternative"],
            line={"color": COLOURS[number % len(COLOURS)]},
            marker={"symbol": SYMBOLS[number % len(SYMBOLS)], "size": 8},
        )
        for number, row in enumerate(frame.iter_rows(named=True))
    ]
    axis = {"title": "rank", "autorange": "reversed"}
    return framed("Ranks from dataset to dataset", traces, yaxis=axis)
