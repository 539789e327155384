"""The function that takes a combination elsewhere, as users of the library call it."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from aerocues.datasets.catalog import DatasetLike
from aerocues.datasets.dataset import Dataset
from aerocues.defaults import FLIGHT_KEYPOINTS, STAGE_TIMEOUT
from aerocues.errors import ArgumentError, SelectionError
from aerocues.exports.files import write_files
from aerocues.exports.recipe import Measured, recipe_of
from aerocues.exports.targets import Target, target_named
from aerocues.methods.combination import Combination
from aerocues.methods.plugins import installed_methods
from aerocues.methods.presets import Preset, as_preset
from aerocues.methods.selection import select_one
from aerocues.modelling.reconstruct import (
    best_combinations,
    features_of_results,
    open_as_measured,
    preset_of_results,
    turned_scene,
)
from aerocues.progress import Progress
from aerocues.reconstruction.options import ReconstructionOptions
from aerocues.reconstruction.protocol import ReconstructionProtocol
from aerocues.results.measured_results import Results, as_results
from aerocues.results.whole_files import write_whole


@dataclass(frozen=True)
class Used:
    """A combination in the form of something else.

    Parameters
    ----------
    target : str
        What it was written as.
    combination : str
    path : path or None
        Where it was written; None if nowhere.
    text : str
        The program or the settings; empty for files.
    figures : mapping of str to int
        Of files: images, keypoints, agreeing matches of the pairs that beat chance, and those that
        COLMAP verified.
    next : tuple of str
        Commands of the tool that go on from the files.
    """

    target: str
    combination: str
    path: Path | None
    text: str = ""
    figures: Mapping[str, int] = field(default_factory=dict)
    next: tuple[str, ...] = ()

    def __str__(self) -> str:
        return self.text or "\n".join(f"{name:17s}{self.figures[name]:,}" for name in self.figures)


def use(
    dataset: DatasetLike | None = None,
    combination: str | Combination | None = None,
    output: str | Path | None = None,
    *,
    target: str = "python",
    results: Results | str | Path | None = None,
    preset: str | Preset | None = None,
    max_keypoints: int | None = None,
    max_width: int | None = None,
    equalize: str | None = None,
    seed: int | None = None,
    pairs: str | None = None,
    subset: str | None = None,
    upright: bool = False,
    refine_keypoints: bool | None = None,
    features_width: int | None = None,
    features: str | Path | None = None,
    timeout: float | str = STAGE_TIMEOUT,
    memory_limit: float | None = None,
    progress: Progress | None = None,
) -> Used:
    """Use a combination elsewhere: as a program in OpenCV alone, or in another tool.

    Parameters
    ----------
    dataset : Dataset, str, path or sequence of paths, optional
        Images of a flight whose features, matches and verified pairs are written; by default those
        of `results`. Programs and settings need none.
    combination : str or Combination, optional
        By default the best of `results`.
    output : path, optional
        File of the program or settings, which need none, or folder of the files.
    target : str
        What it is to be: a program (``python``, ``cpp``), files with the features and matches of a
        flight (``colmap``, ``hloc``, ``opensfm``, ``odm``, ``openmvg``, ``bundler``, ``kapture``),
        or the nearest settings of a tool with a fixed list of features (``rtabmap``,
        ``odm-options``).
    results : Results or path, optional
        Results that it was measured in; everything else is then as it was measured there.
    preset : str or Preset, optional
        Parameters of the methods; by default those of `results`, or ``"default"``.
    max_keypoints : int, optional
        The strongest keypoints that are kept in an image; 0 keeps all. By default as in `results`,
        or all in programs and 8000 in files, as in reconstructions.
    max_width : int, optional
        Wider images are shrunk to so many pixels; 0 for images as they are. By default as in
        `results`, or as they are.
    equalize : {"none", "histogram", "clahe"}, optional
        By default as in `results`, or none.
    seed : int, optional
        By default that of `results`, or 0.
    pairs, subset : str, optional
        Which pairs and images of `dataset`; see `open_dataset`. Neighbours by GPS by default, or
        all pairs where positions are not known.
    upright : bool
        Turn images to a common heading while features are found in them; see `aerocues.upright`.
    refine_keypoints : bool, optional
        Whether keypoints of tracks are refined, as in `reconstruct`.
    features_width : int, optional
        Pixels to which images are shrunk to find features in them; files have them in pixels of the
        images.
    features : path, optional
        Folder in which features are kept, and found if a run kept them there; that of `results`
        by default.
    timeout : float or str
        CPU time of one stage: seconds, or a text such as ``"30min"``.
    memory_limit : float, optional
        Gigabytes of the process that matches.
    progress : callable, optional
        Called with each `aerocues.Event`.

    Returns
    -------
    Used

    Raises
    ------
    AerocuesError
        If an argument makes no sense, there is no such combination, it cannot be used so, or the
        images cannot be linked.
    """
    row = target_named(target)
    measured = None if results is None else as_results(results)
    name = _named(combination, measured)
    given = {
        "max_keypoints": max_keypoints,
        "max_width": max_width,
        "equalize": equalize,
        "seed": seed,
    }
    settings = _settings(measured, preset, given)
    place = None if output is None else Path(output)
    if row.kind != "files":
        if upright:
            raise ArgumentError(f"no images are turned for {row.title}; leave `upright` out")
        if dataset is not None:
            raise ArgumentError(f"images are not needed for {row.title}; leave `dataset` out")
        return _text(row, name, settings, place, measured)
    if place is None:
        raise ArgumentError(f"the files of {row.name} need a folder; give one as `output`")
    scene = (
        dataset
        if isinstance(dataset, Dataset)
        else open_as_measured(
            dataset or _measured_images(measured),
            measured,
            pairs=pairs,
            max_width=max_width,
            equalize=equalize,
            subset=subset,
        )
    )
    limit = settings.max_keypoints or (FLIGHT_KEYPOINTS if max_keypoints is None else 0)
    options = ReconstructionOptions(
        preset=settings.preset,
        protocol=ReconstructionProtocol(
            settings.seed, limit, "refine", features_width=features_width
        ),
        refine_keypoints=refine_keypoints,
        features=features or features_of_results(measured),
        workers=1,
        timeout=timeout,
        memory_limit=memory_limit,
    )
    if upright:
        scene = turned_scene(scene, name, settings.seed, progress)
    written, figures, commands = write_files(row, scene, name, place, options, progress)
    return Used(row.name, written, place, figures=figures, next=commands)


def _named(combination: str | Combination | None, results: Results | None) -> str:
    if combination is not None:
        return str(combination)
    if results is None:
        raise ArgumentError(
            "there is no combination; give one, such as ORB-BEBLID-HAM-BF, or measured `results`"
        )
    dataset = results.settings.get("dataset", {}).get("name")
    return best_combinations(results, dataset, 1)[0]


def _measured_images(results: Results | None) -> str:
    source = {} if results is None else results.settings.get("dataset", {}).get("source") or {}
    if "spec" not in source:
        raise ArgumentError("there are no images; give a folder of them as `dataset`")
    return str(source["spec"])


def _settings(
    results: Results | None, preset: str | Preset | None, given: Mapping[str, Any]
) -> Measured:
    """How it was measured, where nothing else is asked for."""
    facts = {} if results is None else results.settings
    protocol, dataset = facts.get("protocol", {}), facts.get("dataset", {})
    limit, read = protocol.get("limit", {}), dataset.get("settings", {})
    width = str(read.get("max_width", "full"))
    recorded = {
        "max_keypoints": limit.get("count", 0),
        "max_width": 0 if width == "full" else int(width),
        "equalize": read.get("equalize", "none"),
        "seed": protocol.get("seed", 0),
    }
    values = {**recorded, **{name: value for name, value in given.items() if value is not None}}
    values["max_width"] = values["max_width"] or None
    return Measured(
        preset=as_preset(preset or preset_of_results(results)),
        spread=bool(values["max_keypoints"]) and limit.get("spread", False),
        geometry=dataset.get("geometry", "epipolar"),
        **values,
    )


def _text(
    row: Target, combination: str, settings: Measured, output: Path | None, results: Results | None
) -> Used:
    """A program, or the nearest settings of a tool."""
    if row.kind == "program":
        _refuse_turned(results)
        recipe = recipe_of(combination, settings)
        one, text = recipe.combination, str(row.load()(recipe))
    else:
        one = select_one(installed_methods(), combination)
        text = str(row.load()(one, settings, _ranked(results)))
    if output is not None:
        write_whole({output: text.encode()})
    return Used(row.name, str(one), output, text)


def _refuse_turned(results: Results | None) -> None:
    turns = {} if results is None else results.settings.get("dataset", {}).get("turned", {})
    if any(turns.values()):
        raise SelectionError(
            "these results were measured with images turned to a common heading, which a program "
            "does not do; write files of the flight, such as `target='colmap'`, or measure without"
        )


def _ranked(results: Results | None) -> list[str] | None:
    """All measured combinations, the best first."""
    if results is None:
        return None
    dataset = results.settings.get("dataset", {}).get("name")
    return best_combinations(results, dataset, sys.maxsize)
