"""Which combination to take, in minutes: a race on pairs, then models of its leaders."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from aerocues.arguments import seconds_of
from aerocues.datasets.catalog import DatasetLike, open_dataset
from aerocues.datasets.dataset import Dataset
from aerocues.defaults import FLIGHT_KEYPOINTS, RACE_PAIRS, RACE_SECONDS, RACE_WIDTH, SURE
from aerocues.methods.presets import Preset
from aerocues.methods.selection import Patterns
from aerocues.modelling.final import MODELS, SHARE, build_final, has_final
from aerocues.pipeline.upright import turned_upright
from aerocues.progress import Progress
from aerocues.reconstruction.scene import FEATURES
from aerocues.results.store import Store
from aerocues.tuning.device import Device, as_device
from aerocues.tuning.journal import record_answer
from aerocues.tuning.recommend import RaceOptions, recommend_by_race
from aerocues.tuning.recommendation import Recommendation


def recommend(
    dataset: DatasetLike,
    combinations: Patterns | None = None,
    output: str | Path | None = None,
    *,
    budget: float | str = RACE_SECONDS,
    objective: str = "balanced",
    final: bool = True,
    sure: float = SURE,
    max_pairs: int = RACE_PAIRS,
    max_width: int = RACE_WIDTH,
    max_keypoints: int = FLIGHT_KEYPOINTS,
    preset: str | Preset = "default",
    device: Device | Mapping[str, Any] | str | Path | None = None,
    upright: bool = False,
    seed: int = 0,
    workers: int | None = None,
    began: float | None = None,
    progress: Progress | None = None,
) -> Recommendation:
    """Find the combination that suits images best, within a budget of time.

    Pairs are chosen that stand for all; those that show nothing in common are left out. Then
    combinations race: all that are cheap are looked at, and more pairs are measured of those that
    can still win, until one is sure enough to be the best or two thirds of the budget are spent.
    In the rest the leaders build models of the flight, beside COLMAP's default: the best model
    decides.

    Parameters
    ----------
    dataset : Dataset, str, path or sequence of paths
        From `aerocues.open_dataset`, or what that would be given.
    combinations : str, Combination or iterable of both, optional
        Globs such as ``"ORB-*,SIFT-SIFT-*"`` or combinations; all meaningful ones by default.
    output : path, optional
        Results folder, made or continued: an interrupted race goes on from there, and one that is
        finished gives the same answer again. By default ``NAME-race``, of the name of the dataset.
    budget : float or str
        Wall time in all: seconds, or a text such as ``"5min"``.
    objective : {"balanced", "efficiency", "speed", "accuracy", "reconstruction", "robust"}
        What the best is to be best for.
    final : bool
        Whether models decide; otherwise the race does, with the whole budget.
    sure : float
        Probability of the leader, 0.5 to 1, at which the race ends before its time is spent.
    max_pairs : int
        How many pairs stand for all, at most; 2 or more.
    max_width : int
        Wider images are shrunk to this width in pixels; 0: none. A `Dataset` stays as it was
        opened.
    max_keypoints : int
        The strongest keypoints that are kept in an image; 0 keeps all. Thresholds of detectors are
        lowered until they reach so many, but not with the preset ``"thesis"``.
    preset : str or Preset
        Parameters of the methods.
    device : Device, mapping or path, optional
        Machine whose times count: ``compare([here, there]).factors()``, or a file of them; this one
        by default.
    upright : bool
        Turn images to a common heading while features are found in them; see `aerocues.upright`.
    seed : int
        Of all that is random.
    workers : int, optional
        Processes at a time; as many as there are cores by default.
    began : float, optional
        From when on the budget counts, by `time.monotonic`; the call by default.
    progress : callable, optional
        Called with each `aerocues.Event`.

    Returns
    -------
    Recommendation

    Raises
    ------
    AerocuesError
        If an argument makes no sense, the images show nothing in common, nothing succeeds, or
        budget or choice are too small.
    """
    began = time.monotonic() if began is None else began
    seconds, machine = seconds_of("budget", budget), as_device(device)
    options = RaceOptions(seconds, objective, sure, max_pairs, seed, machine)
    if not isinstance(dataset, Dataset):
        dataset = open_dataset(dataset, max_width=max_width)
    final = final and has_final(dataset, seconds)
    if final:
        kept = f"{MODELS}/{FEATURES}"  # models are made of them there, which then removes them
        options = replace(options, budget=seconds * (1 - SHARE), features=kept)
    found = recommend_by_race(
        dataset,
        combinations,
        output,
        options,
        max_keypoints=max_keypoints,
        preset=preset,
        upright=upright,
        workers=workers,
        began=began,
        progress=progress,
    )
    if final:
        if upright:  # by the survey of the race
            dataset = turned_upright(dataset, seed, folder=Store.open(found.folder).surveys)
        left = seconds - found.outcome.rounds[-1].spent
        built = build_final(
            found,
            dataset,
            seconds=left,
            deadline=min(began + seconds, time.monotonic() + left),
            max_keypoints=max_keypoints,
            seed=seed,
            workers=workers,
            progress=progress,
        )
        found = replace(found, final=built)
    record_answer(found.folder, found.facts())
    return found
