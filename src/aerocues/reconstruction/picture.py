"""A picture of a sparse cloud with its cameras: from above and from the side."""

from __future__ import annotations

import io

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from aerocues.results.clouds import Cloud

Array = NDArray[np.float64]
SIZE = (1400, 760)
MARGIN = 40
HEADING = 44
BACKGROUND, INK, CAMERA, TRUE_POSITION = "#ffffff", "#333333", "#d55e00", "#0072b2"
# Share of points at each end of an axis that may lie outside the picture.
OUTLIERS = 0.01
FRUSTUM = 0.035


def picture_of(cloud: Cloud, title: str) -> bytes:
    """A PNG picture: the cloud in its colours, cameras as pyramids, true positions as rings.

    Parameters
    ----------
    cloud : Cloud
    title : str
    """
    image = Image.new("RGB", SIZE, BACKGROUND)
    draw = ImageDraw.Draw(image)
    draw.text((MARGIN, 14), title, fill=INK, font_size=18)
    across, forward, up = _axes(cloud)
    half = SIZE[0] // 2
    for left, axes, heading in (
        (0, (across, forward), "from above"),
        (half, (across, up), "from the side"),
    ):
        box = (left + MARGIN, HEADING + MARGIN, left + half - MARGIN, SIZE[1] - MARGIN)
        draw.text((box[0], HEADING), heading, fill=INK, font_size=14)
        _draw_view(draw, cloud, np.array(axes), box)
    content = io.BytesIO()
    image.save(content, "PNG", optimize=True)
    return content.getvalue()


def _axes(cloud: Cloud) -> tuple[Array, Array, Array]:
    """Axes right, forward and up: those of the world if known, else of the plane of the points."""
    if cloud.unit == "m":
        return tuple(np.eye(3))  # type: ignore[return-value]
    points = cloud.points.astype(np.float64)
    centred = points - points.mean(axis=0)
    up, _, right = np.linalg.eigh(centred.T @ centred)[
        1
    ].T  # from the smallest to the largest spread
    if (cloud.centres.mean(axis=0) - points.mean(axis=0)) @ up < 0:
        up = -up
    return right, np.cross(up, right), up


def _draw_view(
    draw: ImageDraw.ImageDraw, cloud: Cloud, axes: Array, box: tuple[int, int, int, int]
) -> None:
    points, centres = cloud.points @ axes.T, cloud.centres @ axes.T
    low, high = np.quantile(points, [OUTLIERS, 1 - OUTLIERS], axis=0)
    low, high = np.minimum(low, centres.min(axis=0)), np.maximum(high, centres.max(axis=0))
    span = np.maximum(high - low, 1e-9)
    scale = min((box[2] - box[0]) / span[0], (box[3] - box[1]) / span[1])
    middle = (low + high) / 2

    def place(plane: Array) -> Array:
        offset = (plane - middle) * scale * (1, -1)
        centre = np.array([(box[0] + box[2]) / 2, (box[1] + box[3]) / 2])
        placed: Array = offset + centre
        return placed

    for (x, y), colour in zip(place(points), cloud.colours, strict=True):
        if box[0] <= x <= box[2] and box[1] <= y <= box[3]:
            draw.rectangle((x, y, x + 1, y + 1), fill=tuple(colour.tolist()))
    size = FRUSTUM * min(box[2] - box[0], box[3] - box[1]) / scale
    corners = _frustum(cloud, size)
    for centre, position, ends in zip(cloud.centres, cloud.positions, corners, strict=True):
        apex = tuple(place(axes @ centre))
        outline = [tuple(place(axes @ end)) for end in ends]
        for end in outline:
            draw.line([apex, end], fill=CAMERA)
        draw.line([*outline, outline[0]], fill=CAMERA)
        if np.isfinite(position).all():
            x, y = place(axes @ position)
            draw.line([apex, (x, y)], fill=TRUE_POSITION)
            draw.ellipse((x - 4, y - 4, x + 4, y + 4), outline=TRUE_POSITION)


def _frustum(cloud: Cloud, size: float) -> Array:
    """Corners of each camera's image plane, (C, 4, 3), at the distance `size`."""
    focal_length, width, height = cloud.view.tolist()
    x, y = width / 2 / focal_length, height / 2 / focal_length
    rays = size * np.array([[-x, -y, 1], [x, -y, 1], [x, y, 1], [-x, y, 1]])
    found: Array = cloud.centres[:, None, :] + np.einsum("cij,kj->cki", cloud.rotations, rays)
    return found
