"""What is known to be true of a scene, and how a model is brought into its frame."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.dataset import Dataset, TrueView
from aerocues.datasets.gps import east_north_up
from aerocues.datasets.usable_gps import UsableGps
from aerocues.reconstruction.alignment import (
    FEWEST,
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
POSES, GPS, GPS_IN_PLAN = "poses", "gps", "gps in plan"


@dataclass(frozen=True, eq=False)
class TruePositions:
    """Where cameras were.

    Parameters
    ----------
    source : str
        ``poses``, ``gps``, or ``gps in plan`` where heights are left out.
    by_name : mapping of str to (3,) float64
        Centres in metres: east, north, up.
    left_out : mapping of str to str
        Why the positions of other images are not among them, by name.
    """

    source: str
    by_name: Mapping[str, Array]
    left_out: Mapping[str, str] = field(default_factory=dict)

    @property
    def known(self) -> bool:
        """Whether there are enough positions to compare a model with."""
        return len({tuple(each) for each in self.by_name.values()}) >= FEWEST

    @property
    def extent(self) -> float:
        """Diagonal of the box around all of them, in metres."""
        return extent(np.array(list(self.by_name.values())))

    def tolerance(self, requirements: Requirements) -> Array:
        """Metres east, north and up within which a camera counts as in its place."""
        share = requirements.position_error_share * self.extent
        if self.source == POSES:
            return np.full(3, share)
        plan = max(share, requirements.gps_error)
        height = max(share, requirements.gps_height_error)
        return np.array([plan, plan, np.inf if self.source == GPS_IN_PLAN else height])

    def in_plan(self) -> TruePositions:
        """The same without heights, as if all of them were the same."""
        level = float(np.median([each[2] for each in self.by_name.values()]))
        flat = {name: np.array([each[0], each[1], level]) for name, each in self.by_name.items()}
        return TruePositions(GPS_IN_PLAN, flat, self.left_out)


@dataclass(frozen=True, eq=False)
class Located:
    """A model's cameras in the frame of true positions.

    Parameters
    ----------
    truth : TruePositions
    frame : Similarity
        From the model's frame to metres.
    differences : mapping of str to (3,) float64
        Metres from where each registered camera was to where the model has it.
    tolerance : (3,) float64
        Half axes of the ellipsoid within which a camera is in its place.
    """

    truth: TruePositions
    frame: Similarity
    differences: Mapping[str, Array]
    tolerance: Array

    @property
    def errors(self) -> dict[str, float]:
        """Metres from its true position for each camera; in plan where heights are left out."""
        kept = np.isfinite(self.tolerance)
        return {name: float(np.linalg.norm(each[kept])) for name, each in self.differences.items()}

    @property
    def far(self) -> list[str]:
        """Cameras that are not in their place, the farthest first."""
        errors = self.errors
        names = [
            name
            for name, each in self.differences.items()
            if np.linalg.norm(each / self.tolerance) > 1
        ]
        return sorted(names, key=lambda name: (-errors[name], name))


def true_positions(dataset: Dataset) -> TruePositions | None:
    """Known poses, else GPS positions that can be right; None where images have none at all."""
    poses = {image.name: image.truth.centre for image in dataset.images if image.truth}
    if len(poses) >= FEWEST:
        return TruePositions(POSES, poses)
    images = dataset.images
    if all(image.gps is None for image in images):
        return None
    faults = UsableGps.of([image.gps for image in images]).faults
    left_out = {image.name: why for image, why in zip(images, faults, strict=True) if why}
    located = [image for image in images if image.gps and image.name not in left_out]
    positions = east_north_up([image.gps for image in located if image.gps])
    by_name = {image.name: each for image, each in zip(located, positions, strict=True)}
    return TruePositions(GPS, by_name, left_out)


def centres_of(model: Any) -> dict[str, Array]:
    """Centres of the registered cameras in the model's frame, by name of the image."""
    return {
        str(image.name): np.asarray(image.projection_center(), np.float64)
        for image in registered(model)
    }


def locate(
    centres: Mapping[str, Array], truth: TruePositions | None, requirements: Requirements
) -> Located | None:
    """Bring a model's cameras to where they were.

    The frame in which most cameras are in their place: one that is far off bends nothing. Heights
    of GPS are left out where cameras are in their place in plan and would not be with them.

    Parameters
    ----------
    centres : mapping of str to (3,) float64
        Of the registered cameras, in the model's frame.
    truth : TruePositions, optional
    requirements : Requirements

    Returns
    -------
    Located or None
        None where nothing is known or the frame is not determined.
    """
    if truth is None or not truth.known:
        return None
    found = _locate(centres, truth, requirements)
    if found is None or truth.source != GPS:
        return found
    most = (1 - requirements.registered_share) * len(found.differences)
    if len(found.far) <= most:
        return found
    in_plan = _locate(centres, truth.in_plan(), requirements)
    if in_plan is None or len(in_plan.far) > most:
        return found
    return _with_heights(in_plan, centres, truth)


def _with_heights(located: Located, centres: Mapping[str, Array], truth: TruePositions) -> Located:
    """Differences in height, too, as if their median were right."""
    names = list(located.differences)
    there = located.frame.apply(np.array([centres[name] for name in names]))
    differences = there - np.array([truth.by_name[name] for name in names])
    differences[:, 2] -= np.median(differences[:, 2])
    return replace(located, differences=dict(zip(names, differences, strict=True)))


def _locate(
    centres: Mapping[str, Array], truth: TruePositions, requirements: Requirements
) -> Located | None:
    shared = [name for name in centres if name in truth.by_name]
    tolerance = truth.tolerance(requirements)
    estimated = np.array([centres[name] for name in shared]).reshape(-1, 3)
    true = np.array([truth.by_name[name] for name in shared]).reshape(-1, 3)
    frame = robust_similarity(estimated, true, tolerance)
    if frame is None:
        return None
    differences = dict(zip(shared, frame.apply(estimated) - true, strict=True))
    return Located(truth, frame, differences, tolerance)


def compare_with_truth(model: Any, dataset: Dataset, located: Located | None) -> Row:
    """Errors of positions, rotations and surface, as far as the truth is known.

    The extent is that of all true positions, also of images that the model lacks.
    """
    if located is None:
        return {}
    errors = np.array(list(located.errors.values()))
    differences = np.array(list(located.differences.values())).reshape(-1, 3)
    rmse = root_mean_square(errors)
    found: Row = {
        "truth": located.truth.source,
        "position_rmse": rmse,
        "position_median": float(np.median(errors)),
        "position_error_share": rmse / located.truth.extent,
        "plan_rmse": root_mean_square(np.linalg.norm(differences[:, :2], axis=1)),
        "height_rmse": root_mean_square(differences[:, 2]),
        "placed_images": len(errors) - len(located.far),
    }
    if located.truth.source == POSES:
        views = {image.name: image.truth for image in dataset.images if image.truth}
        found["rotation_error"] = _rotation_error(model, views, located.frame)
        depth_errors = surface_errors(model, views, located.frame)
        found["surface_error"] = float(np.median(depth_errors)) if len(depth_errors) else None
    return found


def _rotation_error(model: Any, views: dict[str, TrueView], frame: Similarity) -> float:
    images = [image for image in registered(model) if image.name in views]
    estimated = np.array([camera_from_world(image)[0] @ frame.rotation.T for image in images])
    true = np.array([views[str(image.name)].rotation for image in images])
    return float(np.median(rotation_angles(estimated, true)))


def surface_errors(model: Any, views: Mapping[str, TrueView], frame: Similarity) -> Array:
    """Error in depth of each point of a model, (P,) metres: the median over its images.

    The depth of the point in the true camera is compared with that of the surface. Points that no
    true camera sees are left out.
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
    return np.array([np.median(each) for each in errors.values()])


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
