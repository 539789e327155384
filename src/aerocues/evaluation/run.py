"""The complete measurement: from a dataset and combinations to a results folder."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from aerocues.arguments import seconds_of
from aerocues.datasets.catalog import DatasetLike, as_dataset
from aerocues.datasets.dataset import Dataset
from aerocues.defaults import CALL_TIMEOUT
from aerocues.errors import ArgumentError
from aerocues.evaluation.context import run_facts
from aerocues.evaluation.engine import Engine, Finished
from aerocues.evaluation.passes import Pass, timed_alone
from aerocues.evaluation.plan import Plan, make_plan
from aerocues.evaluation.planned_rows import planned_table
from aerocues.evaluation.run_progress import RunProgress
from aerocues.evaluation.run_settings import RunSettings
from aerocues.evaluation.unit import Context
from aerocues.methods.combination import Combination
from aerocues.methods.presets import Preset
from aerocues.methods.selection import Patterns, select
from aerocues.methods.strongest import keypoint_limit
from aerocues.processes.limits import memory_mb, share_of_memory, worker_count
from aerocues.progress import Progress
from aerocues.results.hashing import content_hash
from aerocues.results.measured_results import Results
from aerocues.results.store import RUN, Store
from aerocues.results.timing import Timing

if TYPE_CHECKING:
    from collections.abc import Generator

    import polars as pl

    from aerocues.evaluation.local_engine import LocalEngine


def local_engine(
    timing: Timing,
    workers: int | None = None,
    timeout: float | str = CALL_TIMEOUT,
    memory_limit: float | None = None,
) -> LocalEngine:
    """The engine for this machine; see `run` for the parameters.

    Raises
    ------
    ArgumentError
        If a limit makes no sense.
    """
    from aerocues.evaluation.local_engine import LocalEngine

    processes = worker_count(workers)
    processes = 1 if timing == "exclusive" else processes
    memory = memory_mb(memory_limit) or share_of_memory(processes)
    return LocalEngine(processes, seconds_of("timeout", timeout), memory)


def run(
    dataset: DatasetLike,
    combinations: Patterns | None = None,
    output: str | Path = "results",
    *,
    detectors: str | Iterable[str] | None = None,
    descriptors: str | Iterable[str] | None = None,
    everything: bool = False,
    preset: str | Preset = "default",
    max_keypoints: int = 0,
    spread: bool = False,
    equal_footing: bool | None = None,
    seed: int = 0,
    timing: Timing = "exclusive",
    timing_pairs: int | None = None,
    upright: bool = False,
    workers: int | None = None,
    timeout: float | str = CALL_TIMEOUT,
    memory_limit: float | None = None,
    features: str | Path | None = None,
    retry_failed: bool = False,
    engine: Engine | None = None,
    progress: Progress | None = None,
) -> Results:
    """Measure combinations on the pairs of a dataset.

    Where nobody chose the pairs of a flight or folder of 5 images or more, it is surveyed: about 24
    pairs then stand for it, and hold every image. Rows that are already in the results folder are
    not measured again. An interrupted run continues.

    Parameters
    ----------
    dataset : Dataset, str, path or sequence of paths
        From `aerocues.open_dataset`, or what that would be given; with ``pairs="consecutive"`` or
        others that you choose there, it is not surveyed.
    combinations : str, Combination or iterable of both, optional
        Globs such as ``"ORB-*-HAM-BF,AKAZE-SIFT-*"`` or combinations; all meaningful ones by
        default.
    output : path
        Results folder, made where it is missing.
    detectors, descriptors : str or iterable of str, optional
        Names or globs of the detectors and descriptors to keep.
    everything : bool
        Take all combinations that can run, not only the meaningful ones.
    preset : str or Preset
        Preset of parameters and protocol, or the file of one.
    max_keypoints : int
        The strongest keypoints that are kept in an image; 0 keeps all.
    spread : bool
        Keep the strongest of each part of the image, in place of the strongest of all.
    equal_footing : bool, optional
        Lower thresholds of detectors until they find `max_keypoints` in the middle image; by
        default under the preset `tuned` alone.
    seed : int
        Set before every stage call.
    timing : {"exclusive", "shared", "estimated"}
        Whether some pairs are timed by themselves once more, or times are those of workers beside
        each other, of brute force on a part of the descriptors where they are estimated. Quality
        does not depend on it.
    timing_pairs : int, optional
        How many pairs exclusive timing takes, a seeded sample; 5 by default, 0 for all. The times
        of the other pairs are scaled by what they show.
    upright : bool
        Turn images to a common heading while features are found in them; see `aerocues.upright`.
    workers : int, optional
        Processes at a time; as many as there are cores by default. Exclusive timing takes one.
    timeout : float or str
        CPU time of one call of a method, and the wall time that it may sit idle: seconds, or a
        text such as ``"5min"``.
    memory_limit : float, optional
        Gigabytes of one worker; by default 80 % of the machine's divided by the workers.
    features : path, optional
        Folder in which features are stored and reused by other runs.
    retry_failed : bool
        Measure again what crashed, raised an error, ran out of time or memory.
    engine : Engine, optional
        Where units of all passes run, such as `aerocues.DaskEngine`; by default worker processes
        on this machine. It has limits of its own.
    progress : callable, optional
        Called with each `aerocues.Event`.

    Returns
    -------
    Results

    Raises
    ------
    AerocuesError
        If an argument, the selection, the images or the results folder do not allow a run. A
        method that fails does not raise: its rows have a status and a message.
    """
    limit = keypoint_limit(max_keypoints, spread=spread)
    asked = RunSettings(preset, seed, timing, timing_pairs, limit, upright, equal_footing)
    engines = _engines(asked, engine, workers, timeout, memory_limit)
    opened = as_dataset(dataset)
    kept_features = _feature_folder(features)
    kept = {"detectors": detectors, "descriptors": descriptors}
    chosen = select(asked.context(opened).methods, combinations, **kept, everything=everything)
    store, told = Store.create(Path(output)), RunProgress(progress)
    opened = asked.measured(opened, told, store)
    asked = asked.with_thresholds(chosen, opened, told, store)
    context = replace(asked.context(opened), features=kept_features, references=store.references)
    turns = asked.passes(opened)
    with store.writing():
        for number, turn in enumerate(turns):
            own = context.timed(turn.timing)
            plan = _plan(own, chosen, turn, store, told.read, retry_failed=retry_failed)
            if number == 0:
                facts = run_facts(context, asked.parts, plan, chosen)
                timed = timed_alone(turns, opened.pairs)
                read = content_hash([opened.geometry, opened.settings])
                _record(store, planned_table(context, read, plan.rows, timed), facts, told)
            told.planned(plan, turn.timing)
            _measure(engines(turn.timing).run(plan.units, own, told.watch), store, told)
    return Results(store.folder)


def _feature_folder(features: str | Path | None) -> Path | None:
    """The folder in which features are kept, if any."""
    if features is None:
        return None
    from aerocues.pipeline.feature_folder import checked_folder

    return checked_folder(Path(features).absolute())


def _engines(
    asked: RunSettings,
    engine: Engine | None,
    workers: int | None,
    timeout: float | str,
    memory_limit: float | None,
) -> Callable[[Timing], Engine]:
    """The engine of each pass; limits are looked at before anything is done."""
    if engine is None:
        local_engine(asked.timing, workers, timeout, memory_limit)
        return lambda timing: local_engine(timing, workers, timeout, memory_limit)
    if workers is not None:
        raise ArgumentError(
            "`workers` is for processes on this machine; leave it out where an `engine` is given"
        )
    return lambda timing: engine


def _record(
    store: Store, planned: pl.DataFrame, facts: Mapping[str, object], told: RunProgress
) -> None:
    """Store the plan; report rows that are no longer part of it."""
    before = store.planned_keys()
    store.write_plan(planned)
    store.write_run(facts)
    aside = store.measured(before - store.planned_keys())
    if aside:
        told.set_aside(len(aside))


def _plan(
    context: Context,
    combinations: Sequence[Combination],
    turn: Pass,
    store: Store | None,
    hashing: Callable[[int, int], None],
    *,
    retry_failed: bool,
) -> Plan:
    """The plan of a pass, without rows that are already stored."""
    present: frozenset[str] = frozenset()
    if store is not None:
        present = store.present(turn.timing, retry_failed=retry_failed)
    return make_plan(context, combinations, present.__contains__, hashing, turn.pairs)


def plan_run(
    dataset: Dataset,
    combinations: Patterns | None = None,
    output: str | Path = "results",
    *,
    detectors: str | Iterable[str] | None = None,
    descriptors: str | Iterable[str] | None = None,
    everything: bool = False,
    preset: str | Preset = "default",
    max_keypoints: int = 0,
    spread: bool = False,
    equal_footing: bool | None = None,
    seed: int = 0,
    timing: Timing = "exclusive",
    timing_pairs: int | None = None,
    upright: bool = False,
    retry_failed: bool = False,
    progress: Progress | None = None,
) -> list[tuple[Timing, Plan]]:
    """What `run` would do with the same arguments, pass by pass; nothing is measured or written.

    A flight whose pairs nobody chose is surveyed for it, about a second an image.
    """
    limit = keypoint_limit(max_keypoints, spread=spread)
    asked = RunSettings(preset, seed, timing, timing_pairs, limit, upright, equal_footing)
    context, told = asked.context(dataset), RunProgress(progress)
    kept = {"detectors": detectors, "descriptors": descriptors}
    chosen = select(context.methods, combinations, **kept, everything=everything)
    store = Store.open(Path(output)) if (Path(output) / RUN).is_file() else None
    opened = asked.measured(dataset, told, store, keep=False)
    asked = asked.with_thresholds(chosen, opened, told, store)
    context = asked.context(opened)
    return [
        (turn.timing, _plan(context, chosen, turn, store, told.read, retry_failed=retry_failed))
        for turn in asked.passes(context.dataset)
    ]


def _measure(
    finished_units: Generator[Finished, None, None], store: Store, told: RunProgress
) -> None:
    with contextlib.closing(finished_units):  # an interruption ends the workers immediately
        for finished in finished_units:
            store.write_finished(finished.unit.detector, finished.rows)
            told.finished(finished)
