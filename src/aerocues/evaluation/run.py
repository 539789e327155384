"""The complete measurement: from a dataset and combinations to a results folder."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from aerocues.datasets.catalog import open_dataset
from aerocues.datasets.dataset import Dataset
from aerocues.errors import SelectionError
from aerocues.evaluation.context import make_context, run_facts
from aerocues.evaluation.engine import Activity, Engine, Finished
from aerocues.evaluation.passes import TIMED_PAIRS, Pass, passes, timed_alone
from aerocues.evaluation.plan import Plan, make_plan
from aerocues.evaluation.planned_rows import planned_table
from aerocues.evaluation.unit import Context
from aerocues.methods.combination import Combination
from aerocues.methods.presets import Preset, as_preset
from aerocues.methods.selection import select
from aerocues.methods.strongest import ALL_KEYPOINTS, KeypointLimit
from aerocues.results.hashing import content_hash
from aerocues.results.measured_results import Results
from aerocues.results.store import RUN, Store
from aerocues.results.timing import Timing

if TYPE_CHECKING:
    from collections.abc import Generator

    import polars as pl

    from aerocues.evaluation.local_engine import LocalEngine

DEFAULT_TIMEOUT = 600.0


class Observer:
    """Told how a run goes on; the base says nothing. Displays override what they show."""

    def hashing(self, done: int, total: int) -> None:
        """`done` of `total` images have been read to tell whether they changed."""

    def set_aside(self, rows: int) -> None:
        """So many rows in the folder, of other settings, count no longer."""

    def planned(self, plan: Plan, timing: Timing) -> None:
        """The work of a pass, which is timed in this way, has been divided into units."""

    def working(self, activities: Sequence[Activity]) -> None:
        """What the workers are doing, several times a second."""

    def finished(self, finished: Finished) -> None:
        """A unit is finished and stored."""


@dataclass(frozen=True)
class Limits:
    """Limits of workers; None means a default for this machine.

    Parameters
    ----------
    workers : int or None
        Number of processes; by default the number of cores. Exclusive timing uses one.
    timeout : float
        Limit of the CPU seconds of one stage call, and of the wall seconds that it may be idle.
    memory_limit_mb : int or None
        Memory of one worker; by default 80 % of the memory of the machine, divided by the number of
        workers.
    """

    workers: int | None = None
    timeout: float = DEFAULT_TIMEOUT
    memory_limit_mb: int | None = None


def usable_cores() -> int:
    """Number of cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def local_engine(limits: Limits, timing: Timing) -> LocalEngine:
    """The engine for this machine.

    Raises
    ------
    SelectionError
        If a limit is not positive.
    """
    import psutil

    from aerocues.evaluation.local_engine import LocalEngine

    workers = limits.workers or usable_cores()
    if workers < 1 or limits.timeout <= 0:
        raise SelectionError("--workers and --timeout must be positive; leave them out to choose")
    workers = 1 if timing == "exclusive" else workers
    memory = limits.memory_limit_mb or int(0.8 * psutil.virtual_memory().total / 2**20 / workers)
    return LocalEngine(workers, limits.timeout, memory)


def _select(
    context: Context,
    combinations: str | Iterable[str | Combination] | None,
    kept: Mapping[str, str | Iterable[str] | None],
    *,
    everything: bool,
) -> list[Combination]:
    patterns: str | list[str] | None
    if combinations is None or isinstance(combinations, str):
        patterns = combinations
    else:
        patterns = [str(combination) for combination in combinations]
    return select(context.methods, patterns, **kept, everything=everything)


def run(
    dataset: Dataset | str,
    combinations: str | Iterable[str | Combination] | None = None,
    output: str | Path = "results",
    *,
    detectors: str | Iterable[str] | None = None,
    descriptors: str | Iterable[str] | None = None,
    everything: bool = False,
    preset: str | Preset = "default",
    seed: int = 0,
    timing: Timing = "exclusive",
    timed_pairs: int = TIMED_PAIRS,
    limit: KeypointLimit = ALL_KEYPOINTS,
    limits: Limits | None = None,
    features: str | Path | None = None,
    retry_failed: bool = False,
    observer: Observer | None = None,
    engine: Engine | None = None,
) -> Results:
    """Measure combinations on the pairs of a dataset.

    Rows that are already in the results folder are not measured again. An interrupted run
    continues.

    Parameters
    ----------
    dataset : Dataset or str
        From `aerocues.open_dataset`, or the text for it.
    combinations : str or iterable, optional
        Globs such as ``"ORB-*-HAM-BF,AKAZE-SIFT-*"`` or combinations; all meaningful ones by
        default.
    output : path
        Results folder; it is created if it does not exist.
    detectors, descriptors, everything
        Restrict or widen the selection of combinations; see `aerocues.methods.selection.select`.
    preset : str or Preset
        Preset of parameters and protocol, or the file of one; see `aerocues.methods.presets`.
    seed : int
        Set before every stage call.
    timing : {"exclusive", "shared", "estimated"}
        ``exclusive`` measures some pairs again to time them on a core of their own. ``shared``
        keeps the times of workers that run side by side. ``estimated`` does too, and times brute
        force on a sample of the descriptors. Quality does not depend on it.
    timed_pairs : int
        Number of pairs with exclusive timing, a seeded sample; 0 for all. They scale the times of
        the other pairs.
    limit : KeypointLimit
        Maximum number of keypoints per image; all by default.
    limits : Limits, optional
        Workers, time and memory.
    features : path, optional
        Folder in which features are stored and reused by other runs.
    retry_failed : bool
        Measure rows again that crashed, raised an error, or exceeded the limits of time or memory.
    observer : Observer, optional
        Receives the progress.
    engine : Engine, optional
        Runs the units of all passes; by default worker processes on this machine.

    Returns
    -------
    Results

    Raises
    ------
    AerocuesError
        If the selection, the images or the results folder are invalid.
    """
    if isinstance(dataset, str):
        dataset = open_dataset(dataset)
    observer = observer or Observer()
    parts = as_preset(preset)
    context = make_context(dataset, parts, seed=seed, timing=timing, limit=limit)
    if features is not None:
        from aerocues.pipeline.feature_folder import checked_folder

        context = replace(context, features=checked_folder(Path(features).absolute()))
    kept = {"detectors": detectors, "descriptors": descriptors}
    chosen = _select(context, combinations, kept, everything=everything)
    turns = passes(dataset.pairs, timing, timed_pairs, seed)
    engines = [engine or local_engine(limits or Limits(), turn.timing) for turn in turns]
    store = Store.create(Path(output))
    with store.writing():
        for number, (turn, runner) in enumerate(zip(turns, engines, strict=True)):
            own = context.timed(turn.timing)
            plan = _plan(own, chosen, turn, store, observer.hashing, retry_failed=retry_failed)
            if number == 0:
                facts = run_facts(context, parts, plan, chosen)
                timed = timed_alone(turns, dataset.pairs)
                read = content_hash([dataset.geometry, dataset.settings])
                _record(store, planned_table(context, read, plan.rows, timed), facts, observer)
            observer.planned(plan, turn.timing)
            _measure(runner.run(plan.units, own, observer.working), store, observer)
    return Results(store.folder)


def _record(
    store: Store, planned: pl.DataFrame, facts: Mapping[str, object], observer: Observer
) -> None:
    """Store the plan; report rows that are no longer part of it."""
    before = store.planned_keys()
    store.write_plan(planned)
    store.write_run(facts)
    aside = store.measured(before - store.planned_keys())
    if aside:
        observer.set_aside(len(aside))


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
    combinations: str | Iterable[str | Combination] | None = None,
    output: str | Path = "results",
    *,
    detectors: str | Iterable[str] | None = None,
    descriptors: str | Iterable[str] | None = None,
    everything: bool = False,
    preset: str | Preset = "default",
    seed: int = 0,
    timing: Timing = "exclusive",
    timed_pairs: int = TIMED_PAIRS,
    limit: KeypointLimit = ALL_KEYPOINTS,
    retry_failed: bool = False,
    observer: Observer | None = None,
) -> list[tuple[Timing, Plan]]:
    """The plans of `run` for the same arguments, pass by pass. Nothing is measured or written."""
    parts = as_preset(preset)
    context = make_context(dataset, parts, seed=seed, timing=timing, limit=limit)
    kept = {"detectors": detectors, "descriptors": descriptors}
    chosen = _select(context, combinations, kept, everything=everything)
    store = Store.open(Path(output)) if (Path(output) / RUN).is_file() else None
    hashing = (observer or Observer()).hashing
    return [
        (turn.timing, _plan(context, chosen, turn, store, hashing, retry_failed=retry_failed))
        for turn in passes(dataset.pairs, timing, timed_pairs, seed)
    ]


def _measure(
    finished_units: Generator[Finished, None, None], store: Store, observer: Observer
) -> None:
    with contextlib.closing(finished_units):  # an interruption ends the workers immediately
        for finished in finished_units:
            store.write_finished(finished.unit.detector, finished.rows)
            observer.finished(finished)
