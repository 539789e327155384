"""Turns a dataset and options into a scene: methods, settings, combinations and cameras."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from aerocues.datasets.dataset import Dataset
from aerocues.errors import ImageError, ReconstructionError
from aerocues.methods.combination import Combination
from aerocues.methods.plugins import installed_methods
from aerocues.methods.presets import Preset, as_preset
from aerocues.methods.selection import Patterns, select, split_names
from aerocues.methods.strongest import limited
from aerocues.pipeline.feature_folder import checked_folder
from aerocues.reconstruction.colmap import colmap_version
from aerocues.reconstruction.engine import ReconstructionLimits, prepare_images
from aerocues.reconstruction.focal_lengths import told_taken, with_those_of_others
from aerocues.reconstruction.images import cameras_of
from aerocues.reconstruction.options import ReconstructionOptions
from aerocues.reconstruction.prepared import read_prepared, write_prepared
from aerocues.reconstruction.protocol import ReconstructionProtocol
from aerocues.reconstruction.reconstruction_progress import ReconstructionProgress
from aerocues.reconstruction.scene import FEATURES, Scene
from aerocues.results.reconstruction_schema import BASELINE
from aerocues.results.versions import machine_name, software_versions


def check_scene(dataset: Dataset) -> None:
    """Refuse a dataset that cannot be reconstructed: ReconstructionError."""
    if dataset.geometry != "epipolar":
        raise ReconstructionError(
            f"the images of {dataset.name} are related by homographies and have no depth; "
            "reconstruct a folder or a flight"
        )
    sequences = list(dict.fromkeys(pair.sequence for pair in dataset.pairs))
    if len(sequences) > 1:
        raise ReconstructionError(
            f"{dataset.name} has {len(sequences)} scenes ({', '.join(sequences[:5])}, ...); "
            "choose one with `sequences`"
        )


def scene_of(dataset: Dataset, output: Path, options: ReconstructionOptions) -> Scene:
    """The scene under the given options; its cameras are not known yet."""
    preset = as_preset(options.preset)
    unordered = {frozenset((pair.image_1, pair.image_2)): pair for pair in reversed(dataset.pairs)}
    once = [
        pair for pair in dataset.pairs if unordered[frozenset((pair.image_1, pair.image_2))] is pair
    ]
    dataset = replace(dataset, pairs=once)
    keys, unreadable = _image_keys(dataset)
    scene = Scene(
        dataset=dataset,
        methods=limited(installed_methods().with_preset(preset), options.protocol.max_keypoints),
        preset=preset.name,
        protocol=_protocol(options, preset),
        folder=output.absolute(),
        features=_features_folder(output, options),
        machine=machine_name(),
        image_keys=keys,
        wanted=options.wanted,
        versions=(software_versions()["opencv"], colmap_version()),
    )
    return scene.without(unreadable)


def _image_keys(dataset: Dataset) -> tuple[dict[str, str], dict[str, str]]:
    """Hashes of images by name, and why those cannot be read that have none."""
    keys, unreadable = {}, {}
    for image in dataset.images:
        try:
            keys[image.name] = image.source.content_key()
        except ImageError as error:
            unreadable[image.name] = str(error)
    return keys, unreadable


def _protocol(options: ReconstructionOptions, preset: Preset) -> ReconstructionProtocol:
    """The protocol as the preset has it: that of the thesis leaves out what came later."""
    given, refine = options.protocol, options.refine_keypoints
    return replace(
        given,
        chance=given.chance if preset.chance_test else None,
        refinement=given.refinement if (preset.unbiased if refine is None else refine) else None,
        error_limit=given.error_limit if preset.unbiased else None,
        thresholds=preset.thresholds,
    )


def _features_folder(output: Path, options: ReconstructionOptions) -> Path:
    """The folder of features: a temporary one, unless a folder is given."""
    if options.features is None:
        return output.absolute() / FEATURES
    return checked_folder(Path(options.features).absolute())


def chosen_combinations(
    scene: Scene,
    combinations: Patterns,
    tell: ReconstructionProgress,
) -> list[Combination]:
    """The combinations in the order asked for, where each was named; else in that of the tables.

    None where COLMAP's default alone is named: it is made beside all others.
    """
    if baseline_alone(combinations):
        return []
    patterns = beside_baseline(combinations)
    chosen = select(scene.methods, patterns)
    if not isinstance(combinations, str):
        place = {name: number for number, name in enumerate(patterns)}
        chosen.sort(key=lambda each: place.get(str(each), len(place)))
    gray = any(image.source.is_gray() for image in scene.dataset.images)
    needs_colour = [
        each for each in chosen if scene.methods.descriptors[each.descriptor].needs_colour
    ]
    if gray and needs_colour:
        chosen = [each for each in chosen if each not in needs_colour]
        reason = (
            f"{needs_colour[0].descriptor} needs three colour channels, but the images are gray"
        )
        if not chosen:
            raise ReconstructionError(f"{reason}; choose other combinations")
        tell.left_out(needs_colour, reason)
    return chosen


def beside_baseline(combinations: Patterns) -> list[str]:
    """Patterns of combinations, one by one, without the name of COLMAP's default."""
    return [name for name in split_names(combinations) if name != str(BASELINE)]


def baseline_alone(combinations: Patterns) -> bool:
    """Whether nothing but COLMAP's default is named."""
    return bool(split_names(combinations)) and not beside_baseline(combinations)


def told_unreadable(scene: Scene) -> str:
    """Which images are left out because they cannot be read; an error where few are left.

    Raises
    ------
    ReconstructionError
        If fewer than three images, or half of them, can be read.
    """
    count, reason = len(scene.left_out), next(iter(scene.left_out.values()))
    total = len(scene.dataset.images) + count
    cannot = f"{count} of {total} images cannot be read ({', '.join(list(scene.left_out)[:3])}"
    cannot += ", ...)" if count > 3 else ")"
    if len(scene.dataset.images) < max(3, total / 2):
        raise ReconstructionError(f"{cannot}: {reason}")
    return f"left out: {cannot}: {reason}"


def with_cameras(scene: Scene, limits: ReconstructionLimits, tell: ReconstructionProgress) -> Scene:
    """The scene with its cameras; images that are not in the folder yet are written there."""
    known = read_prepared(scene.folder, scene.image_keys)
    write_prepared(
        scene.folder, scene.image_keys, known
    )  # removed first, as its images are overwritten
    left = [image.name for image in scene.dataset.images if image.name not in known]
    unreadable = {}
    for name, found in prepare_images(scene, left, limits, tell.read).items():
        if isinstance(found, str):
            unreadable[name] = found
        else:
            known[name] = found
    write_prepared(scene.folder, scene.image_keys, known)
    scene = scene.without(unreadable)
    if scene.left_out:
        tell.note(told_unreadable(scene))
    prepared = [known[image.name] for image in scene.dataset.images]
    prepared, taken = with_those_of_others(prepared)
    if taken and scene.protocol.focal_length is None:
        tell.note(told_taken(taken, prepared))
    return replace(scene, cameras=cameras_of(scene.dataset, prepared, scene.protocol))
