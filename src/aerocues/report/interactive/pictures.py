"""Two images side by side with the matches of a combination."""

from __future__ import annotations

import base64
from typing import TYPE_CHECKING, Any

import cv2
import numpy as np
from numpy.typing import NDArray

from aerocues.errors import AerocuesError
from aerocues.methods.combination import Combination
from aerocues.pipeline.two_images import MatchedImages
from aerocues.report.drawing_process import DrawingProcess
from aerocues.report.interactive.drawing import framed
from aerocues.report.interactive.view import View
from aerocues.report.reopening import context_of

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

INLIER, OUTLIER = "#56B4E9", "#E69F00"
MOST_DRAWN = 500
WIDEST = 1600
QUALITY = 85
SECONDS = 120.0


def matches(view: View) -> Figure | str:
    """Matches of the best combination on a pair, found again; outliers can be shown, too."""
    try:
        context = context_of(view.found)
    except AerocuesError as error:
        return str(error)
    number = view.pairs[0]["pair"] if view.pair is None else view.pair
    combination = Combination.parse(view.names[view.positions[0]])
    pair = context.dataset.pair(number)
    with DrawingProcess(context) as process:
        found = process.draw(number, combination, SECONDS)
    if isinstance(found, str):
        return found
    images = [context.dataset.image(name).read().bgr for name in (pair.image_1, pair.image_2)]
    title = f"{combination}: {pair.image_1} and {pair.image_2}"
    return side_by_side(title, (images[0], images[1]), found.matches, found.inliers)


def matches_of(matched: MatchedImages) -> Figure:
    """The same for what `aerocues.match` found."""
    lines = np.hstack([matched.points_1, matched.points_2])
    return side_by_side(repr(matched), matched.images, lines, matched.inliers)


def side_by_side(
    title: str,
    images: tuple[NDArray[np.uint8], NDArray[np.uint8]],
    lines: NDArray[np.float32],
    inliers: NDArray[np.bool_],
) -> Figure:
    """Both images with lines from keypoint to keypoint; outliers are hidden at first."""
    first, second = images
    height, offset = max(first.shape[0], second.shape[0]), first.shape[1]
    width = offset + second.shape[1]
    traces = [
        _lines(lines[inliers], offset, "inliers", INLIER),
        _lines(lines[~inliers], offset, "outliers", OUTLIER),
    ]
    traces[1].visible = "legendonly"
    pictures = [
        _placed(first, 0, height, width),
        _placed(second, offset, height, width),
    ]
    hidden = {"visible": False, "constrain": "domain"}
    return framed(
        title,
        traces,
        images=pictures,
        xaxis={**hidden, "range": [0, width]},
        yaxis={**hidden, "range": [height, 0], "scaleanchor": "x"},
        height=120 + round(1000 * height / width),
    )


def _lines(lines: NDArray[np.float32], offset: int, name: str, colour: str) -> Any:
    """Lines as one trace with gaps, a seeded sample where there are too many."""
    from plotly.graph_objects import Scattergl

    rng = np.random.default_rng(0)
    count = min(len(lines), MOST_DRAWN)
    kept = lines[np.sort(rng.choice(len(lines), count, replace=False))] if len(lines) else lines
    gap = np.full(len(kept), np.nan)
    x = np.column_stack([kept[:, 0], kept[:, 2] + offset, gap]).ravel()
    y = np.column_stack([kept[:, 1], kept[:, 3], gap]).ravel()
    shown = f"{len(lines):,} {name}"
    shown = shown if count == len(lines) else f"{count:,} of {shown}"
    return Scattergl(
        x=x, y=y, name=shown, mode="lines", line={"color": colour, "width": 1}, hoverinfo="skip"
    )


def _placed(bgr: NDArray[np.uint8], left: int, height: int, width: int) -> dict[str, Any]:
    """An image in the units of the axes, as a JPEG no wider than a screen."""
    factor = min(1.0, WIDEST / width)
    size = (max(1, round(bgr.shape[1] * factor)), max(1, round(bgr.shape[0] * factor)))
    small = cv2.resize(bgr, size, interpolation=cv2.INTER_AREA) if factor < 1 else bgr
    _, content = cv2.imencode(".jpg", small, [cv2.IMWRITE_JPEG_QUALITY, QUALITY])
    coded = base64.b64encode(content.tobytes()).decode()
    return {
        "source": f"data:image/jpeg;base64,{coded}",
        "xref": "x",
        "yref": "y",
        "x": left,
        "y": 0,
        "sizex": bgr.shape[1],
        "sizey": bgr.shape[0],
        "sizing": "stretch",
        "layer": "below",
    }
