"""Makes 3D models of a scene, as users of the library call it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from aerocues.arguments import check_whole
from aerocues.datasets.catalog import DatasetLike
from aerocues.datasets.dataset import Dataset, with_turns
from aerocues.defaults import FLIGHT_KEYPOINTS, RECONSTRUCTED, STAGE_TIMEOUT
from aerocues.errors import ArgumentError, ReconstructionError
from aerocues.methods.combination import Combination
from aerocues.methods.plugins import installed_methods
from aerocues.methods.preset_files import recorded_preset
from aerocues.methods.presets import Preset, as_preset, preset_named, preset_names
from aerocues.methods.selection import Patterns, select
from aerocues.methods.strongest import keypoint_limit
from aerocues.pipeline.equal_footing import at_equal_footing
from aerocues.pipeline.upright import turned_upright
from aerocues.progress import Progress, StageProgress
from aerocues.reconstruction.models import Models
from aerocues.reconstruction.opening import open_scene
from aerocues.reconstruction.options import ReconstructionOptions
from aerocues.reconstruction.protocol import Intrinsics, Mapper, ReconstructionProtocol
from aerocues.reconstruction.reconstruct import open_results, reconstruct_scene
from aerocues.reconstruction.scene import Wanted
from aerocues.reconstruction.scene_making import baseline_alone, beside_baseline, check_scene
from aerocues.results.measured_results import Results, as_results
from aerocues.results.study_place import refuse_part
from aerocues.scoring.cues import score
from aerocues.scoring.measured import table_of


def reconstruct(
    dataset: DatasetLike,
    combinations: Patterns | None = None,
    output: str | Path = "models",
    *,
    results: Results | str | Path | None = None,
    top: int | None = None,
    preset: str | Preset | None = None,
    max_keypoints: int = FLIGHT_KEYPOINTS,
    intrinsics: Intrinsics = "calibrated",
    focal_length: float | None = None,
    mapper: Mapper = "incremental",
    refine_keypoints: bool | None = None,
    features_width: int | None = None,
    equal_footing: bool | None = None,
    reference: str | Combination | None = None,
    baseline: bool = True,
    colours: bool = True,
    undistort: bool = False,
    upright: bool = False,
    seed: int = 0,
    features: str | Path | None = None,
    workers: int | None = None,
    timeout: float | str = STAGE_TIMEOUT,
    memory_limit: float | None = None,
    retry_failed: bool = False,
    progress: Progress | None = None,
) -> Models:
    """Reconstruct a scene in 3D with COLMAP, once with each of some combinations.

    Pairs, intrinsics, verification and mapping are the same for all. What is there already is not
    made again; what was interrupted is.

    Parameters
    ----------
    dataset : Dataset, str, path or sequence of paths
        From `aerocues.open_dataset`, or what that would be given; images are then read as those of
        `results`, and matched with their neighbours by GPS, or where those are not known, with all
        others.
    combinations : str, Combination or iterable of both, optional
        Globs such as ``"ORB-*-HAM-BF"``, or combinations. ``"COLMAP-SIFT-L2-COLMAP"`` alone is
        COLMAP's default alone.
    output : path
        Folder of models, made where it is missing: a folder a combination.
    results : Results or path, optional
        Results of the same images: their best combinations are reconstructed where none are
        named, and the figures and clouds are stored there, too.
    top : int, optional
        How many of the best; 10 by default.
    preset : str or Preset, optional
        Parameters of the methods; by default those of `results`, or ``"default"``.
    max_keypoints : int
        The strongest keypoints that are kept in an image; 0 keeps all.
    intrinsics : {"calibrated", "fixed", "refine"}
        ``calibrated``: focal length and distortion are estimated once for all models, by COLMAP's
        default, if the images determine them. ``fixed``: they stay at known values. ``refine``:
        they are adjusted with each model.
    focal_length : float, optional
        Pixels, in place of what EXIF tells.
    mapper : {"incremental", "global"}
        Of COLMAP.
    refine_keypoints : bool, optional
        Whether keypoints of tracks are refined by least-squares matching before COLMAP gets them;
        by default they are, but with the preset ``"thesis"``.
    features_width : int, optional
        Pixels to which images are shrunk to find features in them, while keypoints are refined, and
        models made, at the width of the images; by default that width.
    equal_footing : bool, optional
        Whether thresholds of detectors are lowered until they find `max_keypoints` in an image, so
        that methods are compared and not thresholds; by default they are, but not with `results`,
        which have their own, nor with the preset ``"thesis"``.
    reference : str or Combination, optional
        To whose cloud distances are measured; the best model by default.
    baseline : bool
        Whether COLMAP's default is a row of the table, too: its own SIFT and matcher, a camera
        that it refines, and the same number of features.
    colours, undistort : bool
        Whether points are coloured; whether undistorted images are written for a dense step.
    upright : bool
        Turn images to a common heading while features are found in them; see `aerocues.upright`.
    seed : int
        Of every stage.
    features : path, optional
        Folder in which features are kept, and found if a run kept them there; that of `results`
        by default.
    workers : int, optional
        Processes at a time; as many as there are cores by default.
    timeout : float or str
        CPU time of one stage: seconds, or a text such as ``"30min"``.
    memory_limit : float, optional
        Gigabytes of one process; by default 80 % of the machine's divided by the workers.
    retry_failed : bool
        Try again what crashed, raised an error, or ran out of time or memory.
    progress : callable, optional
        Called with each `aerocues.Event`.

    Returns
    -------
    Models

    Raises
    ------
    AerocuesError
        If an argument, the scene, the selection or a folder does not allow it. A reconstruction
        that fails is a row with its reason, and no error.
    """
    _check_chosen(combinations, results, top, baseline=baseline)
    measured = None if results is None else as_results(results)
    scene = dataset if isinstance(dataset, Dataset) else open_as_measured(dataset, measured)
    if measured is not None:
        refuse_part(measured.given)
    store = None if measured is None else open_results(measured.folder, scene)
    if combinations is None and measured is not None:
        combinations = best_combinations(
            measured, scene.name, RECONSTRUCTED if top is None else top
        )
    assert combinations is not None
    parts = as_preset(preset or preset_of_results(measured))
    options = ReconstructionOptions(
        preset=parts,
        protocol=ReconstructionProtocol(
            seed, max_keypoints, intrinsics, focal_length, mapper, features_width=features_width
        ),
        refine_keypoints=refine_keypoints,
        wanted=Wanted(colours, undistort),
        reference=None if reference is None else str(reference),
        features=features or features_of_results(measured),
        workers=workers,
        timeout=timeout,
        memory_limit=memory_limit,
        baseline=baseline,
        retry_failed=retry_failed,
    )
    if upright:
        scene = turned_scene(scene, combinations, seed, progress)
    if measured is None if equal_footing is None else equal_footing:
        parts = preset_at_equal_footing(
            scene, combinations, parts, max_keypoints, seed=seed, progress=progress
        )
        options = replace(options, preset=parts)
    return reconstruct_scene(scene, combinations, Path(output), options, progress, store)


def _check_chosen(
    combinations: Patterns | None, results: object, top: int | None, *, baseline: bool
) -> None:
    """Raise AerocuesError unless it is clear of what models are made."""
    if combinations is not None and top is not None:
        raise ArgumentError("`top` chooses among `results`; leave `top` or `combinations` out")
    if combinations is None and results is None:
        raise ReconstructionError(
            "there are no combinations; give some as `combinations`, or measured `results`"
        )
    if not baseline and combinations is not None and baseline_alone(combinations):
        raise ArgumentError(
            "`combinations` names COLMAP's default alone; leave `baseline=False` out"
        )
    if top is not None:
        check_whole("top", top, 1)


def turned_scene(
    scene: Dataset, combinations: Patterns, seed: int, progress: Progress | None
) -> Dataset:
    """The scene with images that are turned to a common heading; see `aerocues.upright`.

    That takes time, so that it is looked first whether scene and combinations will do.
    """
    check_scene(scene)
    if not baseline_alone(combinations):
        select(installed_methods(), beside_baseline(combinations))
    told = StageProgress(progress, "surveying the flight", "images and pairs")
    turned = turned_upright(scene, seed, told.count)
    told.say(turned.notes[-1])
    return turned


def preset_at_equal_footing(
    scene: Dataset,
    combinations: Patterns,
    preset: Preset,
    max_keypoints: int,
    *,
    seed: int,
    progress: Progress | None,
) -> Preset:
    """The preset with thresholds that reach so many keypoints; see `at_equal_footing`."""
    if baseline_alone(combinations):
        return preset
    methods = installed_methods().with_preset(preset)
    told = StageProgress(progress, "setting thresholds", "detectors")
    changed, _ = at_equal_footing(
        *(methods, preset, scene.images, select(methods, beside_baseline(combinations))),
        keypoint_limit(max_keypoints),
        seed=seed,
        progress=told.count,
    )
    return changed


def open_as_measured(
    dataset: str | Path | Sequence[str | Path],
    results: Results | None,
    *,
    pairs: str | None = None,
    max_width: int | None = None,
    equalize: str | None = None,
    sequences: str | None = None,
    subset: str | None = None,
    band: int | None = None,
    every: float | str | None = None,
) -> Dataset:
    """The scene, read as results of it were measured where nothing else is asked for.

    Parameters
    ----------
    dataset, pairs, max_width, equalize, sequences, subset, band, every
        As `aerocues.open_dataset` takes them, so that a `max_width` of 0 is for images as they are
        whatever the results were measured on; images are matched with their neighbours by GPS, or
        where those are not known, with all others.
    results : Results, optional
        Images that were turned to a common heading there are turned here, too.
    """
    measured = settings_of_results(results)
    turns = {} if results is None else (results.settings.get("dataset") or {}).get("turned", {})
    width = measured.get("max_width", "full")
    if band is None and "band" in measured:
        band = int(measured["band"])
    if max_width is None and width != "full":
        max_width = int(width)
    scene = open_scene(
        dataset,
        pairs=pairs,
        max_width=max_width,
        equalize=equalize or measured.get("equalize", "none"),
        sequences=sequences,
        subset=subset or measured.get("subset"),
        band=band,
        every=every or measured.get("every"),
    )
    return with_turns(scene, turns) if turns else scene


def best_combinations(results: Results, dataset: str, top: int) -> list[str]:
    """The best combinations of measured results by CUES, without figures of reconstructions."""
    measured = table_of(results, dataset=dataset, reconstruction=False)
    scores = score(measured.table, measured.preset.settings)
    names = scores.table.alternatives
    return [names[position] for position in scores.order[:top]]


def settings_of_results(results: Results | None) -> dict[str, str]:
    """How images of results were read: the names of options and their values."""
    if results is None:
        return {}
    read = (results.settings.get("dataset") or {}).get("settings", {})
    wanted = ("max_width", "equalize", "subset", "band", "every")
    return {name: str(read[name]) for name in wanted if read.get(name) is not None}


def features_of_results(results: Results | None) -> Path | None:
    """The folder in which a run kept its features, if it is still there."""
    kept = None if results is None else results.settings.get("features")
    return Path(kept) if kept and Path(kept).is_dir() else None


def preset_of_results(results: Results | None) -> Preset:
    """The preset that results were measured under; the default one where that is not known."""
    if results is not None:
        settings = results.settings
        if "preset_parts" in settings or settings.get("preset") in preset_names():
            return recorded_preset(settings)
    return preset_named("default")
