"""Parameters that suit each method: searched on some scenes, judged on others, kept if they pay."""

from __future__ import annotations

import contextlib
import time
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from aerocues.datasets.dataset import Dataset
from aerocues.errors import SelectionError
from aerocues.evaluation.context import make_context
from aerocues.evaluation.engine import Activity
from aerocues.evaluation.run import Limits, local_engine
from aerocues.evaluation.unit import Context
from aerocues.methods.parameters import Value
from aerocues.methods.plugins import installed_methods
from aerocues.methods.preset_files import place_for_preset, write_preset
from aerocues.methods.presets import Preset, preset_named
from aerocues.methods.strongest import ALL_KEYPOINTS, KeypointLimit
from aerocues.results.store import Store
from aerocues.results.versions import machine_name, software_versions
from aerocues.tuning.pair_evaluator import PairEvaluator
from aerocues.tuning.search import Finding, Search, TuningDataset
from aerocues.tuning.search_objective import CUES, search_objective
from aerocues.tuning.search_spaces import SearchSpace, search_spaces_named
from aerocues.tuning.splits import Split, given_split, split_pairs

PAIRS = 16


class Listener:
    """Told how a search goes on; the base says nothing."""

    def hashing(self, done: int, total: int) -> None:
        """`done` of `total` images have been read."""

    def begins(self, space: SearchSpace, number: int, total: int) -> None:
        """A search begins."""

    def found(self, finding: Finding) -> None:
        """A search is over."""

    def working(self, activities: Sequence[Activity]) -> None:
        """What the workers are doing, several times a second."""


@dataclass(frozen=True)
class TuneOptions:
    """How parameters are searched.

    Parameters
    ----------
    objective : str
        ``cues`` or the name of a criterion.
    pairs : int
        Pairs to choose by, and as many to judge by, of all data sets together.
    seed : int
    budget : float
        Wall seconds; what is not finished then stays at its default.
    limit : KeypointLimit
        How many keypoints of an image are kept: what is equal for all candidates.
    """

    objective: str = CUES
    pairs: int = PAIRS
    seed: int = 0
    budget: float = float("inf")
    limit: KeypointLimit = ALL_KEYPOINTS


@dataclass(frozen=True)
class Tuned:
    """The preset that was written, and what each search found."""

    preset: Preset
    findings: list[Finding]
    splits: list[Split]
    folder: Path


def tune(
    names: Sequence[str],
    datasets: Sequence[Dataset],
    output: str | Path,
    *,
    validation: Sequence[Dataset] = (),
    grid: Mapping[str, tuple[Value, ...]] | None = None,
    options: TuneOptions | None = None,
    results: str | Path | None = None,
    limits: Limits | None = None,
    listener: Listener | None = None,
) -> Tuned:
    """Search parameters and write those that pay as a preset.

    Each space is searched with everything else at its default: all settings of its grid on
    training pairs (of a large grid, the better third after a third of the pairs), then the best
    against the default on validation pairs of other scenes. It is kept if the 95 % interval of its
    gain lies above 0.

    Parameters
    ----------
    names : sequence of str
        See `search_spaces.search_spaces_named`.
    datasets : sequence of Dataset
    output : path
        File of the preset.
    validation : sequence of Dataset
        To judge by; where there are none, some scenes of `datasets` are kept for that.
    grid : mapping, optional
        Values of parameters to try, in place of the default ones; for one method.
    options : TuneOptions, optional
    results : path, optional
        Folder of the measurements, made or continued; beside `output` by default.
    limits : Limits, optional
        Workers, time and memory.
    listener : Listener, optional
        Told how it goes on.

    Raises
    ------
    AerocuesError
        If a name or an option makes no sense, or the images do not allow a split.
    """
    began = time.monotonic()
    options, listener = options or TuneOptions(), listener or Listener()
    file, methods = Path(output), installed_methods()
    objective = search_objective(options.objective)
    spaces = search_spaces_named(names, methods, grid)
    every = _named_apart([*datasets, *validation])
    datasets, validation = every[: len(datasets)], every[len(datasets) :]
    place_for_preset(file)
    splits = (
        given_split(datasets, validation, options.pairs)
        if validation
        else split_pairs(datasets, options.seed, options.pairs)
    )
    base = preset_named("default")
    folder = Path(results) if results else file.with_name(f"{file.stem}-search")
    store = Store.create(folder)
    with store.writing(), contextlib.ExitStack() as engines:
        searched = []
        for dataset, split in zip(every, splits, strict=True):
            context = _context(_part(dataset, split), base, spaces, options)
            asked = dict.fromkeys(
                space.variant(number) for space in spaces for number in range(len(space.settings))
            )
            evaluator = PairEvaluator(context, list(asked), store, base, listener.hashing)
            engine = local_engine(limits or Limits(), "estimated")
            searched.append(
                TuningDataset(evaluator, engines.enter_context(engine.standing(context)), split)
            )
        search = Search(
            searched,
            objective,
            options.seed,
            began + options.budget,
            listener.working,
        )
        findings = []
        for number, space in enumerate(spaces, start=1):
            listener.begins(space, number, len(spaces))
            findings.append(search.run(space))
            listener.found(findings[-1])
    preset = Preset(file.stem, "parameters found by aerocues tune", chance_test=True)
    for finding in findings:
        if finding.pays:
            preset = finding.space.applied(preset, finding.best, methods)
    preset.check(methods.detectors, methods.descriptors)
    write_preset(file, preset, _made(every, splits, options, findings))
    return Tuned(preset, findings, splits, folder)


def _named_apart(datasets: Sequence[Dataset]) -> list[Dataset]:
    """The data sets; those of one name have the folder above them in it.

    Raises
    ------
    SelectionError
        If two have one name all the same.
    """
    counts = Counter(each.name for each in datasets)
    named = [each if counts[each.name] == 1 else _with_folder(each) for each in datasets]
    name, count = Counter(each.name for each in named).most_common(1)[0]
    if count > 1:
        raise SelectionError(
            f"{count} data sets are called {name}; give each once, and rename those that differ"
        )
    return named


def _with_folder(dataset: Dataset) -> Dataset:
    above = Path(dataset.source.spec).parent.name if dataset.source else ""
    return replace(dataset, name=f"{above}/{dataset.name}") if above else dataset


def _part(dataset: Dataset, split: Split) -> Dataset:
    chosen = {*split.training, *split.validation}
    pairs = [pair for pair in dataset.pairs if pair.index in chosen]
    used = {name for pair in pairs for name in (pair.image_1, pair.image_2)}
    images = [image for image in dataset.images if image.name in used]
    return replace(dataset, pairs=pairs, images=images)


def _context(
    dataset: Dataset, base: Preset, spaces: Sequence[SearchSpace], options: TuneOptions
) -> Context:
    """What the workers need, with every candidate as a method of its own."""
    context = make_context(
        dataset, base, seed=options.seed, timing="estimated", limit=options.limit
    )
    methods = installed_methods()
    thresholds: dict[str, float] = {}
    for space in spaces:
        methods = space.added(methods)
        thresholds.update(space.thresholds())
    return replace(
        context,
        methods=options.limit.limited(methods),
        protocol=replace(context.protocol, thresholds=thresholds),
    )


def _made(
    datasets: Sequence[Dataset],
    splits: Sequence[Split],
    options: TuneOptions,
    findings: Sequence[Finding],
) -> dict[str, Any]:
    """The record of a search, for its preset."""
    return {
        "versions": software_versions(),
        "machine": machine_name(),
        "objective": options.objective,
        "seed": options.seed,
        "max_keypoints": options.limit.count,
        "datasets": [
            {
                "name": dataset.name,
                "settings": dict(dataset.settings),
                "split_by": split.by,
                "training": [_told(dataset, number) for number in split.training],
                "validation": [_told(dataset, number) for number in split.validation],
            }
            for dataset, split in zip(datasets, splits, strict=True)
        ],
        "searches": [
            {
                "search_space": finding.space.name,
                "judged_in": str(finding.space.combination),
                "tried": finding.tried,
                "best": dict(finding.best),
                "gain": finding.gain,
                "interval": [finding.low, finding.high],
                "judged_by": asdict(finding.judged_by) if finding.judged_by else None,
                "default": asdict(finding.default) if finding.default else None,
                "tuned": asdict(finding.tuned) if finding.tuned else None,
                "kept": finding.pays,
                "why_not": finding.why_not,
            }
            for finding in findings
        ],
    }


def _told(dataset: Dataset, number: int) -> str:
    pair = dataset.pair(number)
    return f"{pair.sequence}: {pair.image_1} {pair.image_2}"
