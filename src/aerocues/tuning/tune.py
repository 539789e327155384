"""Parameters that suit each method: searched on some scenes, judged on others, kept if they pay."""

from __future__ import annotations

import contextlib
import math
import time
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from aerocues.arguments import check_whole, seconds_of
from aerocues.datasets.catalog import DatasetLike, as_dataset
from aerocues.datasets.dataset import Dataset
from aerocues.defaults import TUNING_PAIRS
from aerocues.errors import SelectionError
from aerocues.evaluation.context import make_context
from aerocues.evaluation.run import local_engine
from aerocues.evaluation.unit import Context
from aerocues.methods.combination import Combination
from aerocues.methods.plugins import installed_methods
from aerocues.methods.preset_files import place_for_preset, write_preset
from aerocues.methods.presets import Preset, preset_named
from aerocues.methods.registry import Methods
from aerocues.methods.strongest import ALL_KEYPOINTS, KeypointLimit, keypoint_limit
from aerocues.progress import Progress
from aerocues.results.store import Store
from aerocues.results.versions import machine_name, software_versions
from aerocues.tuning.grids import GridValues, as_grid
from aerocues.tuning.pair_evaluator import PairEvaluator
from aerocues.tuning.search import FEWEST_PAIRS, Finding, Search, TuningDataset
from aerocues.tuning.search_objective import CUES, search_objective
from aerocues.tuning.search_progress import SearchProgress
from aerocues.tuning.search_spaces import SearchSpace, search_spaces_named
from aerocues.tuning.splits import Split, given_split, split_pairs


@dataclass(frozen=True)
class TuneOptions:
    """How parameters are searched; see `tune`."""

    objective: str = CUES
    max_pairs: int = TUNING_PAIRS
    seed: int = 0
    budget: float = math.inf
    limit: KeypointLimit = ALL_KEYPOINTS

    def __post_init__(self) -> None:
        check_whole("max_pairs", self.max_pairs, FEWEST_PAIRS)
        check_whole("seed", self.seed, 0)


@dataclass(frozen=True)
class Tuned:
    """What tuning found.

    Parameters
    ----------
    preset : Preset
        What pays, as it was written.
    findings : list of Finding
        How each search ended.
    splits : list of Split
        Pairs to choose by and to judge by, of each dataset.
    folder : Path
        With all that was measured.
    """

    preset: Preset
    findings: list[Finding]
    splits: list[Split]
    folder: Path

    def __repr__(self) -> str:
        paying = [finding.space.name for finding in self.findings if finding.pays]
        kept = ", ".join(paying) or "none"
        return f"Tuned {self.preset.name}: {len(self.findings)} searched, these pay: {kept}"


def tune(
    dataset: DatasetLike | Sequence[DatasetLike],
    methods: str | Iterable[str],
    output: str | Path,
    *,
    validation: DatasetLike | Sequence[DatasetLike] = (),
    grid: GridValues | str | Path | None = None,
    objective: str = CUES,
    max_pairs: int = TUNING_PAIRS,
    max_keypoints: int = 0,
    budget: float | str | None = None,
    seed: int = 0,
    results: str | Path | None = None,
    workers: int | None = None,
    progress: Progress | None = None,
) -> Tuned:
    """Search parameters and write those that pay as a preset.

    Each space is searched with everything else at its default: all settings of its grid on
    training pairs (of a large grid, the better third after a third of the pairs), then the best
    against the default on validation pairs of other scenes. It is kept if the 95 % interval of its
    gain lies above 0.

    Parameters
    ----------
    dataset : Dataset, str, path, or sequence of them
        From `aerocues.open_dataset`, or what that would be given; a sequence is of several
        datasets.
    methods : str or iterable of str
        Methods such as ``"LATCH"`` or ``"detector:ORB"``, combinations, or ``"all"``; a text is
        split at its commas.
    output : path
        File of the preset.
    validation : Dataset, str, path, or sequence of them
        To judge by; where there are none, some scenes of `dataset` are kept for that.
    grid : mapping or path, optional
        Values of parameters to try, such as ``{"threshold": [5, 10, 20]}``, in place of the
        default ones; for one method.
    objective : str
        ``cues`` or the name of a criterion.
    max_pairs : int
        Pairs to choose by, and as many to judge by, of all datasets together; 3 or more.
    max_keypoints : int
        The strongest keypoints that are kept in an image, the same for all candidates; 0: all.
    budget : float or str, optional
        Wall time: seconds, or a text such as ``"30min"``. What is not finished then stays at its
        default.
    seed : int
        Of all that is random.
    results : path, optional
        Folder of the measurements, made or continued; beside `output` by default.
    workers : int, optional
        Processes at a time; as many as there are cores by default.
    progress : callable, optional
        Called with each `aerocues.Event`.

    Returns
    -------
    Tuned

    Raises
    ------
    AerocuesError
        If a name or an argument makes no sense, or the images do not allow a split.
    """
    began = time.monotonic()
    seconds = math.inf if budget is None else seconds_of("budget", budget)
    options = TuneOptions(objective, max_pairs, seed, seconds, keypoint_limit(max_keypoints))
    engine = local_engine("estimated", workers)
    file, installed = Path(output), installed_methods()
    names = methods.split(",") if isinstance(methods, str) else methods
    spaces = search_spaces_named([name for name in names if name.strip()], installed, as_grid(grid))
    aim = search_objective(objective)
    place_for_preset(file)
    training, judging = _opened(dataset), _opened(validation)
    every = _named_apart([*training, *judging])
    training, judging = every[: len(training)], every[len(training) :]
    splits = (
        given_split(training, judging, max_pairs)
        if judging
        else split_pairs(training, seed, max_pairs)
    )
    store = Store.create(Path(results) if results else file.with_name(f"{file.stem}-search"))
    tell, base = SearchProgress(progress, len(spaces)), preset_named("default")
    with store.writing(), contextlib.ExitStack() as engines:
        searched = []
        for each, split in zip(every, splits, strict=True):
            context = _context(_part(each, split), base, spaces, options)
            context = replace(context, references=store.references)
            evaluator = PairEvaluator(context, _variants(spaces), store, base, tell.read)
            own = engines.enter_context(engine.standing(context))
            searched.append(TuningDataset(evaluator, own, split))
        search = Search(searched, aim, seed, began + seconds, tell.watch)
        findings = []
        for space in spaces:
            findings.append(search.run(space))
            tell.found(findings[-1])
    preset = _paying(findings, file.stem, installed)
    write_preset(file, preset, _made(every, splits, options, findings))
    return Tuned(preset, findings, splits, store.folder)


def _opened(datasets: DatasetLike | Sequence[DatasetLike]) -> list[Dataset]:
    """The datasets; a sequence is of several."""
    if isinstance(datasets, Dataset | str | Path):
        return [as_dataset(datasets)]
    return [as_dataset(each) for each in datasets]


def _variants(spaces: Sequence[SearchSpace]) -> list[Combination]:
    """All candidates of all spaces."""
    numbered = ((space, number) for space in spaces for number in range(len(space.settings)))
    return list(dict.fromkeys(space.variant(number) for space, number in numbered))


def _paying(findings: Sequence[Finding], name: str, methods: Methods) -> Preset:
    """The preset of what pays."""
    preset = Preset(name, "parameters found by aerocues tune", chance_test=True)
    for finding in findings:
        if finding.pays:
            preset = finding.space.applied(preset, finding.best, methods)
    preset.check(methods.detectors, methods.descriptors)
    return preset


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
