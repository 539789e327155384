"""Figures of the times."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from aerocues.report.interactive.drawing import SYMBOLS, dots, framed, line
from aerocues.report.interactive.view import Array, View, label_of
from aerocues.report.relation_figures import STAGES
from aerocues.report.score_figures import COLOURS
from aerocues.results.medians import combination_medians

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

SECONDS = "median seconds for one image (detect, describe) and one pair (match, verify)"
NOT_MEASURED = "times were not measured"


def _medians(view: View, name: str) -> Array:
    """(combinations,) medians of a time."""
    found = combination_medians(view.found.rows)
    known = dict(found.select("combination", name).iter_rows())
    return np.array([known.get(each, np.nan) for each in view.names], dtype=np.float64)


def times(view: View) -> Figure | str:
    """Where the time of the best goes: stacked medians of the stages."""
    from plotly.graph_objects import Bar

    names = view.named(view.best)
    traces = []
    for number, stage in enumerate(STAGES):
        values = _medians(view, f"{stage}_seconds")[view.best]
        if np.isfinite(values).any():
            hover = f"%{{y}}<br>{stage}: %{{x:.3g}} s<extra></extra>"
            bar = {"orientation": "h", "marker_color": COLOURS[number], "hovertemplate": hover}
            traces.append(Bar(x=values, y=names, name=stage, **bar))
    if not traces:
        return NOT_MEASURED
    return framed(view.found.name, traces, rows=len(names), barmode="stack", xaxis_title=SECONDS)


def times_per_thousand(view: View) -> Figure | str:
    """Mean seconds for a thousand matches, and for a thousand inliers."""
    from plotly.graph_objects import Scatter

    names = view.named(view.best)
    traces = [
        Scatter(
            x=view.means(column)[view.best],
            y=names,
            mode="markers",
            name=label_of(column).removeprefix("seconds "),
            marker={"color": COLOURS[number], "symbol": SYMBOLS[number], "size": 9},
            hovertemplate="%{y}<br>%{x:.3g} s<extra></extra>",
        )
        for number, column in enumerate(view.known("seconds_per_1k"))
    ]
    if not traces:
        return NOT_MEASURED
    axis = {"title": "seconds for a thousand", "type": "log"}
    return framed(view.found.name, traces, rows=len(names), xaxis=axis)


def times_by_method(view: View) -> Figure | str:
    """Seconds to detect by detector, and to describe by descriptor; one dot a combination."""
    from plotly.graph_objects import Box

    traces, count = [], 0
    for number, (stage, by) in enumerate((("detect", 0), ("describe", 1))):
        values = _medians(view, f"{stage}_seconds")
        known = [position for position in view.positions if np.isfinite(values[position])]
        methods = [f"{view.parts[position][by]} ({stage})" for position in known]
        count += len(set(methods))
        box = {"boxpoints": "all", "pointpos": 0, "orientation": "h"}
        hover = "%{text}<br>%{x:.3g} s<extra></extra>"
        if known:
            text = [view.names[position] for position in known]
            box |= {"text": text, "hovertemplate": hover, "marker_color": COLOURS[number]}
            traces.append(Box(x=values[known], y=methods, name=stage, **box))
    if not traces:
        return NOT_MEASURED
    axis = {"title": "median seconds for one image", "type": "log"}
    return framed(view.found.name, traces, rows=count, xaxis=axis)


def matchers(view: View) -> Figure | str:
    """Seconds to match with brute force against FLANN, one dot a detector, descriptor and norm."""
    position = {name: number for number, name in enumerate(view.names)}
    with_flann = {
        number: position.get("-".join([*view.parts[number][:3], "FLANN"]))
        for number in view.positions
        if view.parts[number][3] == "BF"
    }
    values = _medians(view, "match_seconds")
    flann = np.full(len(values), np.nan)
    for brute_force, other in with_flann.items():
        if other is not None:
            flann[brute_force] = values[other]
    both = np.isfinite(values) & np.isfinite(flann)
    if not both.any():
        return "no combination was measured with both matchers"
    ends = [float(min(values[both].min(), flann[both].min())), float(values[both].max())]
    traces = dots(view, values, flann, by=2, log=True, behind=[line(ends, ends)])
    axes = [{"title": f"seconds with {name}", "type": "log"} for name in ("brute force", "FLANN")]
    return framed(view.found.name, traces, xaxis=axes[0], yaxis=axes[1])


def machines(view: View) -> Figure | str:
    """Times on another machine over those on the first, by stage, with 90 % of the rows."""
    from plotly.graph_objects import Scatter

    from aerocues.scoring.across import machines_of, times_between

    known = [
        (first, second, times)
        for first, second in machines_of([found.entry for found in view.entries])
        if not isinstance(times := times_between(first, second), str)
    ]
    if not known:
        return "no dataset was measured on two machines"
    traces = []
    for number, (first, second, frame) in enumerate(known):
        ratio, low, high = (frame[name].to_numpy() for name in ("ratio", "ratio_low", "ratio_high"))
        traces.append(
            Scatter(
                x=ratio,
                y=frame["stage"].to_list(),
                mode="markers",
                name=f"{second.name} / {first.name}",
                error_x={"symmetric": False, "array": high - ratio, "arrayminus": ratio - low},
                marker={"color": COLOURS[number % len(COLOURS)], "size": 9},
            )
        )
    axis = {"title": "time on the second machine / on the first", "type": "log"}
    return framed("Between machines", traces, rows=len(known[0][2]), xaxis=axis)
