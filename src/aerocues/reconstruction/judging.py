"""What a model is worth: its figures, its place, and the files that show it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from aerocues.datasets.usable_gps import told_left_out
from aerocues.methods.combination import Combination
from aerocues.phrases import count
from aerocues.reconstruction.colmap import registered
from aerocues.reconstruction.diagnosis import Outcome, judged
from aerocues.reconstruction.exports import export_model, undistort
from aerocues.reconstruction.match_graph import LISTED
from aerocues.reconstruction.matched_scene import Names
from aerocues.reconstruction.picture import picture_of
from aerocues.reconstruction.quality import cloud_of, model_figures
from aerocues.reconstruction.scene import Scene
from aerocues.reconstruction.truth import (
    Located,
    TruePositions,
    centres_of,
    compare_with_truth,
    locate,
    true_positions,
)
from aerocues.results.metrics import Row
from aerocues.results.whole_files import write_whole

CLOUD = "cloud.npz"
PICTURE = "picture.png"
UNKNOWN_PLACE = "whether it is in its place is not known"


def judge(
    model: Any, scene: Scene, combination: Combination, inliers: Mapping[Names, int]
) -> tuple[Row, Outcome]:
    """Measure a model and say whether it is whole and in its place.

    Parameters
    ----------
    model : pycolmap.Reconstruction
        Its points get their colours, where those are wanted.
    scene : Scene
    combination : Combination
    inliers : mapping of pairs to int
        Of the verified pairs.

    Returns
    -------
    figures : Row
    outcome : Outcome
        Model, cloud and picture are then in the folder of the combination.
    """
    if scene.wanted.colours:
        model.extract_colors_for_all_images(str(scene.images))
    requirements = scene.protocol.requirements
    truth = true_positions(scene.dataset)
    located = locate(centres_of(model), truth, requirements)
    figures = {**model_figures(model), **compare_with_truth(model, scene.dataset, located)}
    outcome = judged(
        [image.name for image in scene.dataset.images],
        [str(image.name) for image in registered(model)],
        inliers,
        located,
        requirements,
    )
    told = (outcome.message, *_told_truth(truth, located), _told_unreadable(scene))
    outcome = replace(outcome, message="; ".join(filter(None, told)) or None)
    folder = scene.place(combination)
    _write(model, scene, folder)
    cloud = cloud_of(model, truth, located)
    title = _title(combination, figures, len(scene.dataset.images), outcome)
    write_whole({folder / CLOUD: cloud.content(), folder / PICTURE: picture_of(cloud, title)})
    return figures, outcome


def _told_unreadable(scene: Scene) -> str:
    names = list(scene.left_out)
    shown = ", ".join(names[:LISTED]) + (", ..." if len(names) > LISTED else "")
    return f"{count(len(names), 'image')} cannot be read: {shown}" if names else ""


def _told_truth(truth: TruePositions | None, located: Located | None) -> list[str]:
    """Which positions are left out, and why the place of a model is not known, if it is not."""
    if truth is None:
        return []
    told = [told_left_out(truth.left_out)] if truth.left_out else []
    if not truth.known:
        told.append(f"{UNKNOWN_PLACE}: fewer than three different positions can be used")
    elif located is None:
        told.append(f"{UNKNOWN_PLACE}: the cameras lie on a line")
    return told


def _write(model: Any, scene: Scene, folder: Path) -> None:
    export_model(model, folder)
    if scene.wanted.undistorted:
        undistort(folder, scene.images)


def _title(combination: Combination, figures: Row, images: int, outcome: Outcome) -> str:
    return (
        f"{combination}: {figures['registered_images']} of {images} images, "
        f"{figures['points_3d']:,} points, {figures['reprojection_error']:.2f} px "
        f"({outcome.status})"
    )
