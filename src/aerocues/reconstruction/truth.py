"""The ground truth of a scene, and the alignment of models with it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.dataset import Dataset, TrueView
from aerocues.datasets.gps import east_north_up
from aerocues.reconstruction.alignment import (
    Similarity,
    extent,
    robust_similarity,
    root_mean_square,
    rotation_angles,
)
from aerocues.reconstruction.colmap import camera_from_world, registered
from aerocues.reconstruction.protocol import Requirements
from aerocues.results.metrics import Row

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class TruePositions:
    """True camera positions.

    Parameters
    ----------
    source : str
        ``poses`` or ``gps``.
    by_name : dict of str to (3,) float64
        Centres in metres.
    """

    source: str
    by_name: dict[str, Array]

    @property
    def extent(self) -> float:
        """Diagonal of their bounding box in metres."""
        return extent(np.array(list(self.by_name.values())))

    def tolerance(self, requirements: Requirements) -> float:
        """Largest position error, in metres, of a correctly placed camera."""
        share = requirements.position_error_share * self.extent
        return max(share, requirements.gps_error) if self.source == "gps" else share


def true_positions(dataset: Dataset) -> TruePositions | None:
    """Known poses, else GPS; None if fewer than three images have a position."""
    poses = {image.name: image.truth.centre for image in dataset.images if image.truth}
    if len(poses) >= 3:
        return TruePositions("poses", poses)
    located = [image for image in dataset.images if image.gps is not None]
    if len(located) < 3:
        return None
    # If some images have no altitude, it would be taken from the first image.
    positions = east_north_up([image.gps for image in located if image.gps])
    return TruePositions(
        "gps", {image.name: each for image, each in zip(located, positions, strict=True)}
    )


def centres_of(model: Any) -> dict[str, Array]:
    """Centres of the registered cameras in the frame of the model, by image name."""
    return {
        str(image.name): np.asarray(image.projection_center(), np.float64)
        for image in registered(model)
    }


def to_true_frame(
    model: Any, truth: TruePositions | None, requirements: Requirements
) -> Similarity | None:
    """Similarity from the frame of the model to metres; None if unknown or not determined.

    It places most cameras correctly, so a single outlier has no influence.
    """
    if truth is None:
        return None
    centres = centres_of(model)
    shared = [name for name in centres if name in truth.by_name]
    return robust_similarity(
        np.array([centres[name] for name in shared]).reshape(-1, 3),
        np.array([truth.by_name[name] for name in shared]).reshape(-1, 3),
        truth.tolerance(requirements),
    )


def position_errors(model: Any, truth: TruePositions, frame: Similarity) -> dict[str, float]:
    """Position error of each registered camera in metres, by image name."""
    return {
        name: float(np.linalg.norm(frame.apply(centre) - truth.by_name[name]))
        for name, centre in centres_of(model).items()
        if name in truth.by_name
    }


def compare_with_truth(
    model: Any,
    dataset: Dataset,
    truth: TruePositions | None,
    frame: Similarity | None,
    requirements: Requirements,
) -> Row:
    """Errors of positions, rotations and surface, where the truth is known.

    The extent includes the true positions of images that are not in the model.
    """
    if truth is None or frame is None:
        return {}
    errors = np.array(list(position_errors(model, truth, frame).values()))
    rmse = root_mean_square(errors)
    found: Row = {
        "truth": truth.source,
        "position_rmse": rmse,
        "position_median": float(np.median(errors)),
        "position_error_share": rmse / truth.extent,
        "placed_images": int((errors <= truth.tolerance(requirements)).sum()),
    }
    if truth.source == "poses":
        views = {image.name: image.truth for image in dataset.images if image.truth}
        found["rotation_error"] = _rotation_error(model, views, frame)
        found["surface_error"] = _surface_error(model, views, frame)
    return found


def _rotation_error(model: Any, views: dict[str, TrueView], frame: Similarity) -> float:
    images = [image for image in registered(model) if image.name in views]
    estimated = np.array([camera_from_world(image)[0] @ frame.rotation.T for image in images])
    true = np.array([views[str(image.name)].rotation for image in images])
    return float(np.median(rotation_angles(estimated, true)))


def _surface_error(model: Any, views: dict[str, TrueView], frame: Similarity) -> float | None:
    """Median over points of the median depth error over their images.

    The depth of the point in the true camera is compared with the depth of the surface.
    """
    errors: dict[int, list[float]] = {}
    for image in registered(model):
        view = views.get(str(image.name))
        if view is None or view.depth is None:
            continue
        numbers = [point.point3D_id for point in image.points2D if point.has_point3D()]
        points = np.array([model.points3D[number].xyz for number in numbers]).reshape(-1, 3)
        found = _depth_errors(frame.apply(points), view)
        for number, error in zip(numbers, found, strict=True):
            if np.isfinite(error):
                errors.setdefault(number, []).append(float(error))
    if not errors:
        return None
    return float(np.median([np.median(each) for each in errors.values()]))


def _depth_errors(points: Array, view: TrueView) -> Array:
    """Difference of depth, (N,) metres; NaN behind the camera and outside the image."""
    assert view.depth is not None
    depth = view.depth.read()
    x, y, z = (view.rotation @ (points - view.centre).T).astype(np.float64)
    camera = view.camera
    with np.errstate(divide="ignore", invalid="ignore"):
        column = np.floor(camera.focal_x * x / z + camera.centre_x + 0.5)
        row = np.floor(camera.focal_y * y / z + camera.centre_y + 0.5)
    inside = (z > 0) & (column >= 0) & (column < camera.width) & (row >= 0) & (row < camera.height)
    errors = np.full(len(points), np.nan)
    surface = depth[row[inside].astype(int), column[inside].astype(int)]
    errors[inside] = np.abs(z[inside] - surface)
    return errors
