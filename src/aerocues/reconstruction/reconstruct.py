"""The complete reconstruction: from a scene and combinations to a folder of models."""

from __future__ import annotations

import contextlib
import json
import time
from collections.abc import Iterable, Sequence
from dataclasses import asdict, replace
from pathlib import Path

from aerocues.datasets.dataset import Dataset
from aerocues.errors import ReconstructionError, StoreError
from aerocues.methods.combination import Combination
from aerocues.methods.plugins import installed_methods
from aerocues.methods.presets import as_preset
from aerocues.methods.selection import Patterns, select, split_names
from aerocues.methods.strongest import limited
from aerocues.pipeline.feature_folder import checked_folder
from aerocues.progress import Progress
from aerocues.reconstruction.colmap import colmap_version
from aerocues.reconstruction.engine import (
    ReconstructionLimits,
    in_groups,
    prepare_images,
    run_reconstructions,
)
from aerocues.reconstruction.images import cameras_of, read_prepared, write_prepared
from aerocues.reconstruction.matching import remove_features
from aerocues.reconstruction.models import (
    RETRIED,
    SETTINGS,
    Models,
    has_files,
    read_outcome,
    write_outcome,
    write_table,
)
from aerocues.reconstruction.options import ReconstructionOptions
from aerocues.reconstruction.reconstruction_progress import ReconstructionProgress
from aerocues.reconstruction.references import with_distances
from aerocues.reconstruction.scene import FEATURES, Scene
from aerocues.results.folder_lock import folder_lock
from aerocues.results.metrics import Row
from aerocues.results.store import Store
from aerocues.results.versions import machine_facts, machine_name, software_versions
from aerocues.results.whole_files import json_content, write_whole


def reconstruct_scene(
    dataset: Dataset,
    combinations: Patterns,
    output: Path,
    options: ReconstructionOptions,
    progress: Progress | None = None,
    store: Store | None = None,
) -> Models:
    """Reconstruct a scene with each combination; see `aerocues.reconstruct`.

    Parameters
    ----------
    store : Store, optional
        Results of the same scene, in which rows and clouds are stored, too.
    """
    _check_scene(dataset)
    scene, limits = _scene(dataset, output, options), options.limits()
    tell = ReconstructionProgress(progress)
    chosen = _chosen(scene, combinations, tell)
    reference = Combination.parse(options.reference) if options.reference else None
    if reference is not None and reference not in chosen and not scene.place(reference).is_dir():
        raise _no_reference(reference)
    Models.create(output)
    with folder_lock(output):
        scene = _with_cameras(scene, limits, tell)
        others = _others(scene, chosen)
        if reference is not None and reference not in (*chosen, *others):
            raise _no_reference(reference)
        _write_settings(scene, options)
        finished = _finished(scene, chosen, limits, retry_failed=options.retry_failed)
        tell.planned(len(chosen), len(finished))
        try:
            left = [each for each in chosen if each not in finished]
            for combination, row in _reconstruct(scene, left, limits, tell):
                finished[combination] = row
        finally:  # an interruption loses no finished work
            rows = {**others, **finished}
            if reference in rows and not rows[reference].get("registered_images"):
                tell.without_reference(reference, str(rows[reference]["message"]))
            if rows:
                _write_rows(scene, rows, reference, store)
        remove_features(scene)
    return Models(output)


def _no_reference(reference: Combination) -> ReconstructionError:
    return ReconstructionError(
        f"the reference {reference} is not among the combinations; add it to them"
    )


def _check_scene(dataset: Dataset) -> None:
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


def _scene(dataset: Dataset, output: Path, options: ReconstructionOptions) -> Scene:
    preset = as_preset(options.preset)
    chance = options.protocol.chance if preset.chance_test else None
    unordered = {frozenset((pair.image_1, pair.image_2)): pair for pair in reversed(dataset.pairs)}
    once = [
        pair for pair in dataset.pairs if unordered[frozenset((pair.image_1, pair.image_2))] is pair
    ]
    dataset = replace(dataset, pairs=once)
    return Scene(
        dataset=dataset,
        methods=limited(installed_methods().with_preset(preset), options.protocol.max_keypoints),
        preset=preset.name,
        protocol=replace(options.protocol, chance=chance, thresholds=preset.thresholds),
        folder=output.absolute(),
        features=_features_folder(output, options),
        machine=machine_name(),
        image_keys={image.name: image.source.content_key() for image in dataset.images},
        wanted=options.wanted,
        versions=(software_versions()["opencv"], colmap_version()),
    )


def _features_folder(output: Path, options: ReconstructionOptions) -> Path:
    """The folder of features: a temporary one, unless a folder is given."""
    if options.features is None:
        return output.absolute() / FEATURES
    return checked_folder(Path(options.features).absolute())


def _chosen(
    scene: Scene,
    combinations: Patterns,
    tell: ReconstructionProgress,
) -> list[Combination]:
    """The combinations in the order asked for, where each was named; else in that of the tables."""
    patterns = split_names(combinations)
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


def _with_cameras(
    scene: Scene, limits: ReconstructionLimits, tell: ReconstructionProgress
) -> Scene:
    """The scene with its cameras; images that are not in the folder yet are written there."""
    known = read_prepared(scene.folder, scene.image_keys)
    write_prepared(
        scene.folder, scene.image_keys, known
    )  # removed first, as its images are overwritten
    left = [image.name for image in scene.dataset.images if image.name not in known]
    for each in prepare_images(scene, left, limits, tell.read):
        known[each.name] = each
    write_prepared(scene.folder, scene.image_keys, known)
    prepared = [known[image.name] for image in scene.dataset.images]
    return replace(scene, cameras=cameras_of(scene.dataset, prepared, scene.protocol))


def _write_settings(scene: Scene, options: ReconstructionOptions) -> None:
    source = scene.dataset.source
    facts = {
        "settings_key": scene.settings_key(),
        "dataset": {
            "name": scene.dataset.name,
            "images": len(scene.dataset.images),
            "pairs": len(scene.dataset.pairs),
            "settings": dict(scene.dataset.settings),
            "source": asdict(source) if source else None,
        },
        "preset": scene.preset,
        "protocol": asdict(scene.protocol),
        "cameras": [asdict(group) for group in scene.cameras],
        "time_limit": options.limits().seconds,
        "versions": {**software_versions(), "pycolmap": colmap_version()},
        "machine": machine_facts(),
    }
    write_whole({scene.folder / SETTINGS: json_content(facts)})


def _finished(
    scene: Scene,
    chosen: Iterable[Combination],
    limits: ReconstructionLimits,
    *,
    retry_failed: bool,
) -> dict[Combination, Row]:
    """Rows of finished reconstructions that are still valid."""
    finished = {}
    for combination in chosen:
        row = read_outcome(scene.place(combination))
        if row is None or row.get("row_key") != scene.row_key(combination):
            continue
        if retry_failed and row["status"] in RETRIED:
            continue
        if row["status"] == "timeout" and row.get("time_limit", 0.0) < limits.seconds:
            continue  # it may end within the larger limit
        if row.get("registered_images") and not has_files(scene.place(combination)):
            continue
        finished[combination] = row
    return finished


def _others(scene: Scene, chosen: Sequence[Combination]) -> dict[Combination, Row]:
    """Rows of other models in the folder that were made under the same settings."""
    others = {}
    for place in sorted(scene.folder.glob("*-*-*-*/")):
        row = read_outcome(place)
        if row is None or row.get("settings_key") != scene.settings_key():
            continue
        combination = Combination.parse(place.name)
        if combination not in chosen:
            others[combination] = row
    return others


def _reconstruct(
    scene: Scene,
    combinations: list[Combination],
    limits: ReconstructionLimits,
    tell: ReconstructionProgress,
) -> Iterable[tuple[Combination, Row]]:
    running = run_reconstructions(scene, in_groups(combinations), limits, tell.watch)
    with contextlib.closing(running):  # an interruption ends the processes here and now
        for combination, figures, last in running:
            when = {"reconstructed_at": time.time(), "time_limit": limits.seconds}
            row = {**_identity(scene, combination), **figures, **when}
            write_outcome(scene.place(combination), row)
            if last:
                remove_features(scene, combination)
            tell.finished(row)
            yield combination, row


def _identity(scene: Scene, combination: Combination) -> Row:
    protocol = scene.protocol
    sources = sorted({group.source for group in scene.cameras})
    return {
        "dataset": scene.dataset.name,
        **asdict(combination),
        "images": len(scene.dataset.images),
        "pairs": len(scene.dataset.pairs),
        "preset": scene.preset,
        "parameters": json.dumps(scene.methods.parameters(combination), sort_keys=True),
        "pairing": dict(scene.dataset.settings).get("pairs", "own"),
        "max_keypoints": protocol.max_keypoints,
        "intrinsics": f"{protocol.intrinsics} ({', '.join(sources)})",
        "mapper": protocol.mapper,
        "seed": protocol.seed,
        "opencv_version": scene.versions[0],
        "colmap_version": scene.versions[1],
        "machine": scene.machine,
        "settings_key": scene.settings_key(),
        "row_key": scene.row_key(combination),
    }


def _write_rows(
    scene: Scene,
    finished: dict[Combination, Row],
    reference: Combination | None,
    store: Store | None,
) -> None:
    """Measure distances between clouds, and write the table here and to the results."""
    clouds = Models(scene.folder)
    rows, measured = with_distances(finished, clouds.cloud, reference)
    table = write_table(scene.folder, rows)
    if store is None:
        return
    try:
        with store.writing():
            for key, cloud in measured.items():
                store.write_cloud(key, cloud)
            store.add_reconstructions(table)
    except StoreError as error:
        raise StoreError(f"the models are finished, but {error}") from error


def open_results(folder: str | Path, dataset: Dataset) -> Store:
    """The results in which to store the rows; StoreError if they have another dataset."""
    store = Store.open(Path(folder))
    names = store.plan()["dataset"].unique().to_list()
    if dataset.name not in names:
        raise StoreError(
            f"{folder} has results of {', '.join(sorted(names))}, not of {dataset.name}; "
            "reconstruct the images that they were measured on"
        )
    return store
