"""Figures of the scores."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from aerocues.report.interactive.drawing import framed
from aerocues.report.interactive.view import View, label_of
from aerocues.report.score_figures import COLOURS

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

PANELS_A_ROW = 2


def cues(view: View) -> Figure:
    """CUES of the best with 95 % intervals; filled where not told from the best."""
    from plotly.graph_objects import Scatter

    frame = view.found.ranking.frame("combination")
    rows = {row["combination"]: row for row in frame.iter_rows(named=True)}
    best = [rows[name] for name in view.named(view.best) if name in rows]
    alike = {*view.found.ranking.indistinguishable(), frame["combination"][0]}
    score = np.array([row["score"] for row in best])
    low, high = (
        np.array([row[name] if row[name] is not None else row["score"] for row in best])
        for name in ("score_low", "score_high")
    )
    untested = set(view.found.ranking.untested())
    symbols = [_symbol(row["combination"], alike, untested) for row in best]
    trace = Scatter(
        x=score,
        y=[row["combination"] for row in best],
        mode="markers",
        error_x={"symmetric": False, "array": high - score, "arrayminus": score - low},
        marker={"color": COLOURS[0], "size": 9, "symbol": symbols},
        hovertemplate="%{y}<br>CUES %{x:.3f}<extra></extra>",
    )
    axis = "CUES, 95 % interval (filled: cannot be told from the best; cross: not compared)"
    return framed(view.found.name, [trace], rows=len(best), xaxis_title=axis)


def _symbol(name: str, alike: set[str], untested: set[str]) -> str:
    if name in untested:
        return "x-thin-open"
    return "circle" if name in alike else "circle-open"


def heat_maps(view: View) -> Figure:
    """CUES by detector and descriptor, a panel for each norm and matcher."""
    from plotly.graph_objects import Heatmap
    from plotly.subplots import make_subplots

    shown = [view.parts[position] for position in view.positions]
    scores = view.found.ranking.scores.scores
    detectors, descriptors = (sorted({part[column] for part in shown}) for column in (0, 1))
    panels = sorted({(part[2], part[3]) for part in shown})
    columns, rows = min(PANELS_A_ROW, len(panels)), -(-len(panels) // PANELS_A_ROW)
    figure = make_subplots(rows, columns, subplot_titles=[" ".join(each) for each in panels])
    for number, panel in enumerate(panels):
        z = np.full((len(detectors), len(descriptors)), np.nan)
        for position in view.positions:
            part = view.parts[position]
            if (part[2], part[3]) == panel:
                z[detectors.index(part[0]), descriptors.index(part[1])] = scores[position]
        heat = Heatmap(
            x=descriptors,
            y=detectors,
            z=z,
            coloraxis="coloraxis",
            texttemplate="%{z:.2f}",
            hovertemplate="%{y}-%{x}<br>CUES %{z:.3f}<extra></extra>",
        )
        figure.add_trace(heat, row=number // columns + 1, col=number % columns + 1)
    figure.update_layout(
        title=f"{view.found.name} (empty: incompatible or not measured)",
        template="plotly_white",
        coloraxis={"colorscale": "Cividis", "colorbar": {"title": "CUES"}},
        height=120 + rows * max(120 + 24 * len(detectors), 200),
    )
    figure.update_yaxes(autorange="reversed")
    return figure


def weights(view: View) -> Figure:
    """Weights of the criteria by each method, and their aggregate."""
    from plotly.graph_objects import Bar

    frame = view.found.ranking.weights()
    criteria = [label_of(name) for name in frame["criterion"]]
    traces = [
        Bar(
            x=frame[method].to_list(),
            y=criteria,
            orientation="h",
            name=label_of(method),
            marker_color="black" if method == "aggregate" else COLOURS[number % len(COLOURS)],
        )
        for number, method in enumerate(frame.columns[1:])
    ]
    return framed(view.found.name, traces, rows=2 * len(criteria), xaxis_title="weight")


def pareto(view: View) -> Figure | str:
    """Time against quality, with the combinations that no other one beats in both."""
    from plotly.graph_objects import Scatter

    from aerocues.report.relation_figures import quality_as_scored
    from aerocues.scoring.pareto import pareto_front

    validation = view.found.validation
    if not validation.pareto_criteria:
        return "speed and quality were not both measured"
    criterion, seconds = validation.pareto_criteria[1], view.found.seconds()
    quality = quality_as_scored(view.found.ranking.scores, criterion)
    speed = np.array([seconds.get(name, np.nan) for name in view.names])
    chosen = view.positions[
        np.isfinite(speed[view.positions]) & np.isfinite(quality[view.positions])
    ]
    if not len(chosen):
        return "none of these combinations has a time"
    front = chosen[pareto_front(np.column_stack([-speed[chosen], quality[chosen]]))]
    front = front[np.argsort(speed[front], kind="stable")]
    hover = "%{text}<br>%{x:.3g} s, %{y:.4g}<extra></extra>"
    traces = [
        Scatter(
            x=speed[chosen],
            y=quality[chosen],
            text=view.named(chosen),
            mode="markers",
            name="combinations",
            marker={"color": "#8a8a8a", "size": 6},
            hovertemplate=hover,
        ),
        Scatter(
            x=speed[front],
            y=quality[front],
            text=view.named(front),
            mode="lines+markers",
            name="Pareto front",
            line={"color": COLOURS[5], "shape": "hv"},
            marker={"symbol": "diamond", "size": 9},
            hovertemplate=hover,
        ),
    ]
    return framed(
        view.found.name,
        traces,
        xaxis={"title": "median seconds for one image and one pair", "type": "log"},
        yaxis_title=label_of(criterion),
    )


def components(view: View) -> Figure | str:
    """Mean scores of detectors, descriptors, norms and matchers, and the best of each."""
    from plotly.graph_objects import Scatter

    traces = []
    count = 0
    for number, (component, frame) in enumerate(view.found.validation.hierarchies.items()):
        if component not in ("detectors", "descriptors", "norms", "matchers"):
            continue
        names = [f"{name} ({component[:-1]})" for name in frame["name"]]
        count += len(names)
        for values, symbol, told in (("mean", "circle", "mean"), ("max", "line-ns-open", "best")):
            traces.append(
                Scatter(
                    x=frame[values].to_list(),
                    y=names,
                    mode="markers",
                    text=frame["best"].to_list(),
                    name=f"{component}, {told}",
                    marker={"color": COLOURS[number % len(COLOURS)], "symbol": symbol, "size": 9},
                    hovertemplate=f"%{{y}}<br>{told} %{{x:.3f}}<br>best: %{{text}}<extra></extra>",
                )
            )
    if not traces:
        return "the names of the combinations have no parts"
    return framed(view.found.name, traces, rows=count, xaxis_title="CUES")
