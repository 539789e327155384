"""Quality of a model."""

from __future__ import annotations

from typing import Any

import numpy as np

from aerocues.reconstruction.alignment import Similarity
from aerocues.reconstruction.colmap import camera_from_world, registered
from aerocues.reconstruction.truth import Located, TruePositions
from aerocues.results.clouds import Cloud
from aerocues.results.metrics import Row


def model_figures(model: Any) -> Row:
    """Counts, track length and errors, as COLMAP defines them.

    The reprojection error is the mean over points of the mean error of the observations of a point.
    """
    points = list(model.points3D.values())
    errors = np.array([point.error for point in points])
    lengths = np.array([point.track.length() for point in points])
    cameras = [model.cameras[number] for number in sorted(model.cameras)]
    return {
        "registered_images": len(registered(model)),
        "points_3d": len(points),
        "points_in_3_images": int((lengths >= 3).sum()),
        "observations": int(lengths.sum()),
        "mean_track_length": float(lengths.mean()) if points else None,
        "reprojection_error": float(errors.mean()) if points else None,
        "observation_error": float(np.average(errors, weights=lengths)) if points else None,
        "focal_length": float(cameras[0].mean_focal_length()),
    }


def cloud_of(model: Any, truth: TruePositions | None, located: Located | None) -> Cloud:
    """Points and cameras of a model, in metres if a true frame is known."""
    numbers = sorted(model.points3D)
    points = [model.points3D[number] for number in numbers]
    images = registered(model)
    place = located.frame if located else Similarity(1.0, np.eye(3), np.zeros(3))
    centres = np.array([image.projection_center() for image in images]).reshape(-1, 3)
    unknown = np.full(3, np.nan)
    positions = truth.by_name if truth and located else {}
    camera = model.cameras[images[0].camera_id]
    return Cloud(
        points=_floats(place.apply(np.array([point.xyz for point in points]).reshape(-1, 3))),
        colours=np.array([point.color for point in points], np.uint8).reshape(-1, 3),
        errors=_floats([point.error for point in points]),
        track_lengths=np.array([point.track.length() for point in points], np.int32),
        distances=np.full(len(points), np.nan, np.float32),
        centres=_floats(place.apply(centres)),
        rotations=_floats([place.rotation @ camera_from_world(image)[0].T for image in images]),
        names=np.array([str(image.name) for image in images]),
        positions=_floats([positions.get(str(image.name), unknown) for image in images]),
        view=_floats([camera.mean_focal_length(), camera.width, camera.height]),
        unit="m" if located else "unit",
    )


def _floats(values: Any) -> Any:
    return np.asarray(values, np.float32)
