"""What all interactive figures have in common: colours, frames, matrices, dots by method."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from aerocues.report.interactive.view import View, label_of
from aerocues.report.score_figures import COLOURS

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

Array = NDArray[np.float64]
SYMBOLS = ("circle", "diamond", "square", "cross", "x", "triangle-up", "star", "hexagon")
ROW_HEIGHT = 24
DOTTED = {"color": "#9aa5b1", "width": 1, "dash": "dot"}


def framed(title: str, traces: Sequence[Any], *, rows: int = 0, **layout: Any) -> Figure:
    """A figure of some traces; with `rows`, as high as so many lines need."""
    from plotly.graph_objects import Figure

    height = {"height": 140 + ROW_HEIGHT * max(rows, 2)} if rows else {}
    figure = Figure(list(traces))
    figure.update_layout(
        title=title, template="plotly_white", hovermode="closest", **{**height, **layout}
    )
    if rows:
        figure.update_yaxes(autorange="reversed", type="category")
    return figure


def matrix(title: str, x: Sequence[str], y: Sequence[str], z: Array, what: str) -> Figure:
    """Correlations with their values."""
    from plotly.graph_objects import Heatmap

    names = ([label_of(name) for name in x], [label_of(name) for name in y])
    heat = Heatmap(
        x=names[0],
        y=names[1],
        z=z,
        zmin=min(-1.0, float(np.nanmin(z))) if np.nanmin(z) < 0 else 0.0,
        zmax=1.0,
        colorscale="Cividis",
        texttemplate="%{z:.2f}",
        colorbar={"title": what},
        hovertemplate="%{x}<br>%{y}<br>%{z:.3f}<extra></extra>",
    )
    return framed(title, [heat], rows=len(y))


def dots(
    view: View, x: Array, y: Array, *, by: int, log: bool = False, behind: Sequence[Any] = ()
) -> list[Any]:
    """One dot a combination, coloured by the detector (`by` 0) or another part of its name."""
    from plotly.graph_objects import Scatter

    fits = np.isfinite(x) & np.isfinite(y) & ((x > 0) & (y > 0) if log else True)
    shown = [position for position in view.positions if fits[position]]
    methods = list(dict.fromkeys(view.parts[position][by] for position in shown))
    traces = list(behind)
    for number, method in enumerate(methods):
        own = [position for position in shown if view.parts[position][by] == method]
        traces.append(
            Scatter(
                x=x[own],
                y=y[own],
                name=method,
                mode="markers",
                text=[view.names[position] for position in own],
                hovertemplate="%{text}<br>%{x:.4g}, %{y:.4g}<extra></extra>",
                marker={
                    "color": COLOURS[number % len(COLOURS)],
                    "symbol": SYMBOLS[number // len(COLOURS) % len(SYMBOLS)],
                    "size": 7,
                },
            )
        )
    return traces if len(traces) > len(behind) else []


def line(x: Sequence[float], y: Sequence[float]) -> Any:
    """A dotted line behind points."""
    from plotly.graph_objects import Scatter

    return Scatter(x=x, y=y, mode="lines", line=DOTTED, hoverinfo="skip", showlegend=False)
