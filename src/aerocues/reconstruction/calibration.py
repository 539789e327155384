"""Intrinsics from a model with a refined camera, if the images determine them.

A flat scene seen from straight above fits a longer focal length at a greater distance equally well.
The covariance of the bundle adjustment shows this: the standard deviation of the focal length is
then several percent, and its error many times larger.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, TypeGuard

import numpy as np

from aerocues.reconstruction.colmap import registered
from aerocues.reconstruction.scene import CameraGroup
from aerocues.results.metrics import Row

CAMERA_MODEL = "SIMPLE_RADIAL"
CALIBRATED = "calibrated"
# Largest standard deviation of a focal length that counts as determined, as a share of it.
FOCAL_UNCERTAINTY = 0.002


def calibrations(model: Any, groups: Sequence[CameraGroup]) -> list[Row | None]:
    """Refined parameters of each camera and the uncertainty of its focal length.

    Parameters
    ----------
    model : pycolmap.Reconstruction
        With refined cameras; it is not changed.
    groups : sequence of CameraGroup
        The cameras of the scene.

    Returns
    -------
    list of Row or None
        ``parameters`` in COLMAP's order, and ``focal_uncertainty``: the standard deviation of the
        focal length as a share of it, None if the adjustment is degenerate. None for a camera
        that the model does not have, and in versions of pycolmap without this covariance.
    """
    import pycolmap

    if not hasattr(pycolmap, "create_default_ceres_bundle_adjuster"):
        return [None] * len(groups)
    model = pycolmap.Reconstruction(model)
    images = registered(model)
    covariance, variance = _covariance(model, [image.image_id for image in images])
    cameras = {str(image.name): image.camera_id for image in images}
    found: list[Row | None] = []
    for group in groups:
        number = next((cameras[name] for name in group.names if name in cameras), None)
        camera = None if number is None else model.cameras[number]
        if camera is None:
            found.append(None)
            continue
        parameters = [float(value) for value in camera.params]
        own = None if covariance is None else covariance.get_other_params_cov(camera.params)
        uncertainty = None if own is None else float(np.sqrt(own[0, 0] * variance) / parameters[0])
        found.append({"parameters": parameters, "focal_uncertainty": uncertainty})
    return found


def _covariance(model: Any, images: Sequence[int]) -> tuple[Any, float]:
    """Covariance of all parameters under residuals of one pixel, and the residuals' variance."""
    import pycolmap

    options = pycolmap.BundleAdjustmentOptions()
    options.print_summary = False
    options.ceres.solver_options.num_threads = 1
    config = pycolmap.BundleAdjustmentConfig()
    for image in images:
        config.add_image(image)
    config.fix_gauge(pycolmap.BundleAdjustmentGauge.TWO_CAMS_FROM_WORLD)
    adjuster = pycolmap.create_default_ceres_bundle_adjuster(options, config, model)
    solved: Any = adjuster.solve()
    summary = getattr(solved, "ceres_summary", solved)
    freedom = summary.num_residuals - summary.num_effective_parameters
    wanted = pycolmap.BACovarianceOptions()
    wanted.params = pycolmap.BACovarianceOptionsParams.ALL
    covariance = pycolmap.estimate_ba_covariance(wanted, model, adjuster)
    return covariance, 2 * summary.final_cost / max(freedom, 1)


def with_calibrated(
    groups: Sequence[CameraGroup], found: Sequence[Row | None]
) -> tuple[CameraGroup, ...]:
    """Cameras with calibrated intrinsics where these are determined.

    Parameters
    ----------
    groups : sequence of CameraGroup
    found : sequence of Row or None
        From `calibrations`, in the same order.
    """
    return tuple(
        replace(group, model=CAMERA_MODEL, parameters=tuple(each["parameters"]), source=CALIBRATED)
        if _is_determined(each)
        else group
        for group, each in zip(groups, found, strict=True)
    )


def told_calibration(groups: Sequence[CameraGroup], found: Sequence[Row | None]) -> str:
    """Whether the camera of most images is calibrated, and why not, in one line."""
    number = max(range(len(groups)), key=lambda each: (len(groups[each].names), -each))
    group, each = groups[number], found[number]
    kept = f"{group.parameters[0]:.1f} px of {group.source}" if group.parameters else "a guess"
    if each is None:
        return f"intrinsics: not calibrated, because there is no model to do so; {kept} stays"
    found_length, uncertainty = f"{each['parameters'][0]:.1f} px", each["focal_uncertainty"]
    if uncertainty is not None:
        found_length += f" +- {uncertainty:.2%}"
    if not _is_determined(each):
        return f"intrinsics: the images do not determine them ({found_length}); {kept} stays"
    distortion = f"distortion {each['parameters'][-1]:.4f}"
    return f"intrinsics: calibrated, {found_length}, {distortion}, in place of {kept}"


def _is_determined(found: Row | None) -> TypeGuard[Row]:
    uncertainty = None if found is None else found["focal_uncertainty"]
    return uncertainty is not None and uncertainty <= FOCAL_UNCERTAINTY
