"""True overlap of two images from poses and depth, and pairs chosen by it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from aerocues.datasets.dataset import Image
from aerocues.datasets.true_geometry import Array, Located, find_seen, inverse_depths
from aerocues.errors import DatasetError

_SAMPLES = (24, 16)
"""Points along the width and height of an image at which overlap is measured: more are more exact,
and slower."""


@dataclass(frozen=True)
class Overlapping:
    """All pairs of images whose overlap is between two limits.

    Parameters
    ----------
    least, most : float
        Limits of the overlap: the smaller share of one image that is visible in the other. Occluded
        parts do not count.
    """

    least: float
    most: float = 1.0

    def pairs(self, images: Sequence[Image]) -> list[tuple[str, str]]:
        """Names of the images to match, in order, no pair twice.

        Raises
        ------
        DatasetError
            If images have no true depth, or no two images overlap by so much.
        """
        views = [_sampled(image) for image in images]
        found = [
            (images[i].name, images[j].name)
            for i, j in combinations(range(len(images)), 2)
            if views[i].may_meet(views[j])
            and self.least <= _shared(views[i], views[j]) <= self.most
        ]
        if not found:
            raise DatasetError(
                f"no two images overlap by {self.least:g} to {self.most:g}; give wider limits"
            )
        return found


@dataclass(frozen=True, eq=False)
class _Sampled:
    """A view, points spread over it, and a sphere around the visible surface."""

    located: Located
    points: Array
    centre: Array
    radius: float

    def may_meet(self, other: _Sampled) -> bool:
        distance = float(np.linalg.norm(self.centre - other.centre))
        return distance <= self.radius + other.radius


def _sampled(image: Image) -> _Sampled:
    if image.truth is None or image.truth.depth is None:
        raise DatasetError(
            f"{image.name} has no true depth to tell overlap by; use "
            '`pairs="consecutive"` or `pairs="gps"`'
        )
    located = Located.of(image.truth)
    camera = image.truth.camera
    columns, rows = (
        (np.arange(count) + 0.5) * size / count - 0.5
        for count, size in zip(_SAMPLES, (camera.width, camera.height), strict=True)
    )
    points = np.stack(np.meshgrid(columns, rows), axis=-1).reshape(-1, 2)
    centre, radius = _sphere(located, points)
    return _Sampled(located, points, centre, radius)


def _sphere(located: Located, points: Array) -> tuple[Array, float]:
    """Sphere around the surface at the points; infinite if a point is in the sky."""
    view, camera = located.view, located.view.camera
    _, inverse = inverse_depths(points, located.inverse)
    rays = np.column_stack(
        [
            (points[:, 0] - camera.centre_x) / camera.focal_x,
            (points[:, 1] - camera.centre_y) / camera.focal_y,
            np.ones(len(points)),
        ]
    )
    with np.errstate(divide="ignore", invalid="ignore"):
        surface = rays @ view.rotation / inverse[:, None] + view.centre
    surface = surface[np.isfinite(surface).all(axis=1)]
    if not len(surface):
        return view.centre, float("inf")
    centre = surface.mean(axis=0)
    radius = float(np.linalg.norm(surface - centre, axis=1).max())
    return centre, radius if len(surface) == len(points) else float("inf")


def _shared(first: _Sampled, second: _Sampled) -> float:
    """Share of an image that is visible in the other, the smaller of both directions: 0 to 1."""
    forth = find_seen(first.points, first.located, second.located)[1].mean()
    if not forth:
        return 0.0
    back = find_seen(second.points, second.located, first.located)[1].mean()
    return float(min(forth, back))
