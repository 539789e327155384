"""The whole measurement: dataset and combinations in, a results folder out."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from aerocues.datasets.catalog import open_dataset
from aerocues.datasets.dataset import Dataset
from aerocues.errors import SelectionError
from aerocues.evaluation.context import make_context, run_facts
from aerocues.evaluation.engine import Activity, Engine, Finished
from aerocues.evaluation.plan import Plan, content_hash, make_plan
from aerocues.evaluation.planned_rows import planned_table
from aerocues.evaluation.protocol import Timing
from aerocues.evaluation.results import Results
from aerocues.evaluation.store import RUN, Store
from aerocues.evaluation.unit import Context
from aerocues.methods.combination import Combination
from aerocues.methods.presets import Preset, as_preset
from aerocues.methods.selection import select
from aerocues.methods.strongest import ALL_KEYPOINTS, KeypointLimit

if TYPE_CHECKING:
    from collections.abc import Generator

    from aerocues.evaluation.local_engine import LocalEngine

DEFAULT_TIMEOUT = 600.0


class Observer:
    """Told how a run goes on; the base says nothing. Displays override what they show."""

    def hashing(self, done: int, total: int) -> None:
        """`done` of `total` images have been read to tell whether they changed."""

    def planned(self, plan: Plan) -> None:
        """The work has been divided into units."""

    def working(self, activities: Sequence[Activity]) -> None:
        """What the workers are doing, several times a second."""

    def finished(self, finished: Finished) -> None:
        """A unit is finished and stored."""


@dataclass(frozen=True)
class Limits:
    """What a worker may use; ``None`` stands for a default that suits the machine.

    Parameters
    ----------
    workers : int or None
        Processes at a time; as many as there are cores, one for exclusive timing.
    timeout : float
        CPU seconds of one stage call, and the wall seconds that it may sit idle.
    memory_limit_mb : int or None
        Memory of one worker; 80 % of the machine's divided by the workers.
    """

    workers: int | None = None
    timeout: float = DEFAULT_TIMEOUT
    memory_limit_mb: int | None = None


def usable_cores() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def local_engine(limits: Limits, timing: Timing) -> LocalEngine:
    """The engine for this machine.

    Raises
    ------
    SelectionError
        If several workers are asked for with exclusive timing, or a limit is not positive.
    """
    import psutil

    from aerocues.evaluation.local_engine import LocalEngine

    workers = limits.workers or (1 if timing == "exclusive" else usable_cores())
    if workers < 1 or limits.timeout <= 0:
        raise SelectionError("--workers and --timeout must be positive; leave them out to choose")
    if timing == "exclusive" and workers > 1:
        raise SelectionError(
            "exclusive timing gives one stage call the whole machine; leave --workers out or use "
            "--timing shared"
        )
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
    timing: Timing = "shared",
    limit: KeypointLimit = ALL_KEYPOINTS,
    limits: Limits | None = None,
    retry_failed: bool = False,
    observer: Observer | None = None,
    engine: Engine | None = None,
) -> Results:
    """Measure combinations on the pairs of a dataset.

    What the results folder holds already is not measured again; what was interrupted is.

    Parameters
    ----------
    dataset : Dataset or str
        From `aerocues.open_dataset`, or what that would be given.
    combinations : str or iterable, optional
        Globs such as ``"ORB-*-HAM-BF,AKAZE-SIFT-*"`` or combinations; all meaningful ones by
        default.
    output : path
        Results folder, made where it is missing.
    detectors, descriptors, everything
        Narrow or widen the choice of combinations; see `aerocues.methods.selection.select`.
    preset : str or Preset
        Preset of parameters and protocol, or the file of one; see `aerocues.methods.presets`.
    seed : int
        Set before every stage call.
    timing : {"shared", "exclusive", "estimated"}
        Whether several stages may run at once, and whether brute force is timed on a part of the
        descriptors only; quality does not depend on it.
    limit : KeypointLimit
        How many keypoints of an image are kept; all by default.
    limits : Limits, optional
        Workers, time and memory.
    retry_failed : bool
        Measure again what crashed, raised an error, ran out of time or memory.
    observer : Observer, optional
        Told how it goes on.
    engine : Engine, optional
        Where units run; worker processes on this machine by default.

    Returns
    -------
    Results

    Raises
    ------
    AerocuesError
        If the selection, the images or the results folder do not allow a run.
    """
    if isinstance(dataset, str):
        dataset = open_dataset(dataset)
    observer = observer or Observer()
    engine = engine or local_engine(limits or Limits(), timing)
    parts = as_preset(preset)
    context = make_context(dataset, parts, seed=seed, timing=timing, limit=limit)
    kept = {"detectors": detectors, "descriptors": descriptors}
    chosen = _select(context, combinations, kept, everything=everything)
    store = Store.create(Path(output))
    with store.writing():
        present = store.present(timing, retry_failed=retry_failed)
        plan = make_plan(context, chosen, present.__contains__, observer.hashing)
        dataset_key = content_hash([dataset.geometry, dataset.settings])
        store.write_plan(planned_table(context, dataset_key, plan.rows))
        store.write_run(run_facts(context, parts, plan, chosen))
        observer.planned(plan)
        _measure(engine.run(plan.units, context, observer.working), store, observer)
    return Results(store.folder)


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
    timing: Timing = "shared",
    limit: KeypointLimit = ALL_KEYPOINTS,
    retry_failed: bool = False,
    observer: Observer | None = None,
) -> Plan:
    """What `run` would do with the same arguments; nothing is measured or written."""
    parts = as_preset(preset)
    context = make_context(dataset, parts, seed=seed, timing=timing, limit=limit)
    kept = {"detectors": detectors, "descriptors": descriptors}
    chosen = _select(context, combinations, kept, everything=everything)
    present: frozenset[str] = frozenset()
    if (Path(output) / RUN).is_file():
        present = Store.open(Path(output)).present(timing, retry_failed=retry_failed)
    hashing = (observer or Observer()).hashing
    return make_plan(context, chosen, present.__contains__, hashing)


def _measure(
    finished_units: Generator[Finished, None, None], store: Store, observer: Observer
) -> None:
    with contextlib.closing(finished_units):  # an interruption ends the workers here and now
        for finished in finished_units:
            name = content_hash([row["row_key"] for row in finished.rows])
            store.write_rows(f"{finished.unit.detector}-{name}", finished.rows)
            observer.finished(finished)
