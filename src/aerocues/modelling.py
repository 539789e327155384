"""The function that makes 3D models, as users of the library call it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

from aerocues.datasets.dataset import Dataset
from aerocues.errors import ReconstructionError
from aerocues.methods.combination import Combination
from aerocues.methods.preset_files import recorded_preset
from aerocues.methods.presets import Preset, preset_named, preset_names
from aerocues.reconstruction.models import Models
from aerocues.reconstruction.opening import open_scene
from aerocues.reconstruction.options import ReconstructionObserver, ReconstructionOptions
from aerocues.reconstruction.reconstruct import open_results, reconstruct_scene
from aerocues.results.measured_results import Results
from aerocues.scoring.cues import score
from aerocues.scoring.measured import table_of

TOP = 10


def reconstruct(
    dataset: Dataset | str,
    output: str | Path,
    combinations: str | Iterable[str | Combination] | None = None,
    *,
    results: str | Path | None = None,
    top: int | None = None,
    options: ReconstructionOptions | None = None,
    observer: ReconstructionObserver | None = None,
) -> Models:
    """Reconstruct a scene in 3D with COLMAP, once with each of some combinations.

    Pairs, intrinsics, verification and mapping are the same for all. What is there already is not
    made again; what was interrupted is.

    Parameters
    ----------
    dataset : Dataset or str
        From `aerocues.open_dataset`, or its text form; images are then matched with their
        neighbours by GPS, or where those are not known, with all others.
    output : path
        Folder of models, made where it is missing: a folder a combination.
    combinations : str or iterable, optional
        Globs such as ``"ORB-*-HAM-BF"``, or combinations.
    results : path, optional
        Results of the same images: their best combinations are reconstructed where none are
        named, and the figures and clouds are stored there, too.
    top : int, optional
        How many of the best; 10 by default.
    options : ReconstructionOptions, optional
    observer : ReconstructionObserver, optional
        Told how it goes on.

    Returns
    -------
    Models

    Raises
    ------
    AerocuesError
        If the scene, the selection or a folder does not allow it. A reconstruction that fails is
        a row with its reason, and no error.
    """
    scene = open_as_measured(dataset, results) if isinstance(dataset, str) else dataset
    if combinations is None and results is None:
        raise ReconstructionError(
            "there are no combinations; give some as `combinations`, or measured `results`"
        )
    store = open_results(results, scene) if results is not None else None
    options = options or ReconstructionOptions()
    if options.features is None:
        options = replace(options, features=features_of_results(results))
    if combinations is None:
        assert results is not None
        combinations = best_combinations(results, scene.name, top or TOP)
    return reconstruct_scene(
        scene,
        combinations,
        Path(output),
        options,
        observer or ReconstructionObserver(),
        store,
    )


def open_as_measured(
    spec: str,
    results: str | Path | None,
    *,
    pairs: str | None = None,
    max_width: int | None = None,
    equalize: str | None = None,
    sequences: str | None = None,
    subset: str | None = None,
) -> Dataset:
    """The scene, read as results of it were measured where nothing else is asked for.

    Parameters
    ----------
    spec, pairs, max_width, equalize, sequences, subset
        As `aerocues.open_dataset` takes them, so that a `max_width` of 0 is for images as they are
        whatever the results were measured on; images are matched with their neighbours by GPS, or
        where those are not known, with all others.
    results : path, optional
    """
    measured = settings_of_results(results)
    width = measured.get("max_width", "full")
    if max_width is None and width != "full":
        max_width = int(width)
    return open_scene(
        spec,
        pairs=pairs,
        max_width=max_width,
        equalize=equalize or measured.get("equalize", "none"),
        sequences=sequences,
        subset=subset or measured.get("subset"),
    )


def best_combinations(results: str | Path, dataset: str, top: int) -> list[str]:
    """The best combinations of measured results by CUES, without figures of reconstructions."""
    measured = table_of(Results(results), dataset=dataset, reconstruction=False)
    scores = score(measured.table, measured.preset.settings)
    names = scores.table.alternatives
    return [names[position] for position in scores.order[:top]]


def settings_of_results(results: str | Path | None) -> dict[str, str]:
    """How images of results were read: ``max_width``, ``equalize`` and ``subset``.

    Raises
    ------
    StoreError
        If `results` is no results folder.
    """
    if results is None:
        return {}
    read = (Results(results).settings.get("dataset") or {}).get("settings", {})
    wanted = ("max_width", "equalize", "subset")
    return {name: str(read[name]) for name in wanted if read.get(name) is not None}


def features_of_results(results: str | Path | None) -> Path | None:
    """The folder in which a run kept its features, if it is still there."""
    kept = None if results is None else Results(results).settings.get("features")
    return Path(kept) if kept and Path(kept).is_dir() else None


def preset_of_results(results: str | Path | None) -> Preset:
    """The preset that results were measured under; the default one where that is not known."""
    if results is not None:
        settings = Results(results).settings
        if "preset_parts" in settings or settings.get("preset") in preset_names():
            return recorded_preset(settings)
    return preset_named("default")
