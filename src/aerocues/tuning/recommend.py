"""Which combination to take, in minutes: representative pairs, a race, an answer."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from aerocues.datasets.dataset import Dataset, Image, Pair
from aerocues.errors import SelectionError
from aerocues.evaluation.context import make_context
from aerocues.evaluation.engine import Activity
from aerocues.evaluation.run import Limits, local_engine
from aerocues.evaluation.unit import Context
from aerocues.methods.combination import Combination
from aerocues.methods.presets import Preset, as_preset
from aerocues.methods.selection import select
from aerocues.methods.strongest import ALL_KEYPOINTS, KeypointLimit
from aerocues.results.hashing import content_hash
from aerocues.results.store import Store
from aerocues.scoring.criteria import criteria_named
from aerocues.scoring.objectives import Objective, objective_named
from aerocues.scoring.settings import ScorePreset, score_preset_named
from aerocues.tuning.device import Device
from aerocues.tuning.image_evaluator import ImageEvaluator
from aerocues.tuning.journal import Journal
from aerocues.tuning.pair_evaluator import PairEvaluator
from aerocues.tuning.race import RaceOutcome, RaceSettings, Round, race
from aerocues.tuning.race_ranking import race_ranking
from aerocues.tuning.representative import (
    FEWEST_PAIRS,
    MOST_PAIRS,
    Seen,
    find_overlap,
    probes,
    spread_pairs,
)
from aerocues.tuning.session import Session

if TYPE_CHECKING:
    import polars as pl

BUDGET = 300.0
SURE = 0.95


class Follower:
    """Told how a race goes on; the base says nothing."""

    def hashing(self, done: int, total: int) -> None:
        """`done` of `total` images have been read to tell whether they changed."""

    def looking(self, pairs: int) -> None:
        """It is looked which of so many pairs show the same things."""

    def racing(self, combinations: int, pairs: int) -> None:
        """The race begins."""

    def round(self, finished: Round) -> None:
        """A round is over."""

    def working(self, activities: Sequence[Activity]) -> None:
        """What the workers are doing, several times a second."""


@dataclass(frozen=True)
class RaceOptions:
    """What is raced for, and how long.

    Parameters
    ----------
    budget : float
        Wall seconds in all.
    objective : str
        A row of `scoring.objectives.OBJECTIVES`.
    sure : float
        Probability of the leader at which the race ends before the budget is spent.
    pairs : int
        Pairs that stand for all, at most.
    seed : int
    device : Device, optional
        Whose times count; this machine's by default.
    began : float, optional
        From when on the budget counts, by `time.monotonic`; the call by default.
    """

    budget: float = BUDGET
    objective: str = "balanced"
    sure: float = SURE
    pairs: int = MOST_PAIRS
    seed: int = 0
    device: Device | None = None
    began: float | None = None

    def __post_init__(self) -> None:
        if self.budget <= 0:
            raise SelectionError("--budget must be positive; give it such as 5min")
        if not 0.5 <= self.sure <= 1:
            raise SelectionError("--sure is a probability from 0.5 to 1; give it such as 0.95")
        if self.pairs < FEWEST_PAIRS:
            raise SelectionError("--max-pairs must be 2 or more: one pair says nothing of others")

    def settings(self, objective: Objective, scoring: ScorePreset) -> RaceSettings:
        """Of the race itself."""
        return RaceSettings(
            self.budget, self.seed, sure=self.sure, score=scoring.settings, objective=objective
        )


@dataclass(frozen=True, eq=False)
class Recommendation:
    """What a race found.

    Parameters
    ----------
    dataset : Dataset
        With the pairs that stood for all.
    seen : Seen
    candidates : int
        Pairs of the whole data set.
    objective : Objective
    outcome : RaceOutcome
    ranked : pl.DataFrame
        One row a combination that was measured with success, the best first: ``combination,
        score, probability, pairs, succeeded``, medians over its pairs of
        ``precision_beyond_chance, excess_inliers, total_seconds`` and of the stages, one image
        each: ``detect_seconds, describe_seconds, match_seconds, verify_seconds``.
    combinations, measured : int
        How many raced, and how many of them were measured at all.
    folder : Path
        With all that was measured.
    machine : str
        Whose times count.
    """

    dataset: Dataset
    seen: Seen
    candidates: int
    objective: Objective
    outcome: RaceOutcome
    ranked: pl.DataFrame
    combinations: int
    measured: int
    folder: Path
    machine: str

    @property
    def best(self) -> str:
        """The combination to take."""
        return str(self.ranked["combination"][0])


def recommend(
    dataset: Dataset,
    output: str | Path,
    combinations: str | Iterable[str] | None = None,
    *,
    options: RaceOptions | None = None,
    preset: str | Preset = "default",
    limit: KeypointLimit = ALL_KEYPOINTS,
    limits: Limits | None = None,
    follower: Follower | None = None,
) -> Recommendation:
    """Find the combination that suits images best, within a budget of time.

    Pairs are chosen that stand for all; those that show nothing in common are left out. Then
    combinations race: all that are cheap are looked at, and more pairs are measured of those that
    can still win, until one is sure enough to be the best or the budget is spent.

    Parameters
    ----------
    dataset : Dataset
    output : path
        Results folder, made or continued: an interrupted race goes on from there, and one that is
        finished gives the same answer again.
    combinations : str or iterable of str, optional
        Globs; all meaningful ones by default.
    options : RaceOptions, optional
    preset : str or Preset
        Of parameters.
    limit : KeypointLimit
        How many keypoints of an image are kept.
    limits : Limits, optional
        Workers, time and memory.
    follower : Follower, optional
        Told how it goes on.

    Raises
    ------
    AerocuesError
        If the images show nothing in common, nothing succeeds, or budget or choice are too small.
    """
    options, follower = options or RaceOptions(), follower or Follower()
    began = time.monotonic() if options.began is None else options.began
    objective, parts = objective_named(options.objective), as_preset(preset)
    pairs = spread_pairs(dataset.pairs, options.pairs, options.seed)
    part = replace(dataset, pairs=pairs, images=_used(dataset, pairs))
    context = make_context(part, parts, seed=options.seed, timing="estimated", limit=limit)
    chosen = _chosen(context, combinations)
    store = Store.create(Path(output))
    engine_here = local_engine(limits or Limits(), "estimated")
    with store.writing(), engine_here.standing(context) as engine:
        evaluators = _evaluators(context, chosen, store, parts, follower.hashing)
        journal = Journal.read(store.folder, _key(evaluators, chosen, options), options.budget)
        session = Session(journal, began=began, watch=follower.working)
        follower.looking(len(pairs))
        with engine_here.standing(evaluators.overlap.context) as other:
            own = engine if evaluators.overlap is evaluators.race else other
            seen = find_overlap(evaluators.overlap, own, pairs, session, options.seed)
        follower.racing(len(chosen), len(seen.overlapping))
        scoring = score_preset_named("default" if parts.chance_test else "thesis")
        criteria = criteria_named(objective.criteria(scoring.criteria))
        evaluator = ImageEvaluator(
            evaluators.race, engine, chosen, seen.overlapping, criteria, session, options.device
        )
        outcome = race(evaluator, options.settings(objective, scoring), follower.round)
    return Recommendation(
        part,
        seen,
        len(dataset.pairs),
        objective,
        outcome,
        race_ranking(evaluators.race, chosen, seen.overlapping, outcome, options.device),
        len(chosen),
        int(outcome.known.any(axis=1).sum()),
        store.folder,
        options.device.name if options.device else context.machine,
    )


def _used(dataset: Dataset, pairs: Sequence[Pair]) -> list[Image]:
    names = {name for pair in pairs for name in (pair.image_1, pair.image_2)}
    return [image for image in dataset.images if image.name in names]


def _chosen(context: Context, combinations: str | Iterable[str] | None) -> list[Combination]:
    # One that some pairs rule out cannot be compared on all of them.
    gray = any(image.source.is_gray() for image in context.dataset.images)
    descriptors = context.methods.descriptors
    chosen = [
        each
        for each in select(context.methods, combinations)
        if not (gray and descriptors[each.descriptor].needs_colour)
    ]
    if len(chosen) < 2:
        raise SelectionError("a race needs two combinations; let `combinations` choose more")
    return chosen


@dataclass(frozen=True)
class _Evaluators:
    """Of overlap, and of the race: the same one unless the preset has no test against chance."""

    overlap: PairEvaluator
    race: PairEvaluator


def _evaluators(
    context: Context,
    chosen: Sequence[Combination],
    store: Store,
    preset: Preset,
    hashing: Callable[[int, int], None],
) -> _Evaluators:
    """Whether images overlap is always tested against chance, whatever the preset says."""
    if context.protocol.chance is not None:
        asked = list(dict.fromkeys([*chosen, *probes()]))
        evaluator = PairEvaluator(context, asked, store, preset, hashing)
        return _Evaluators(evaluator, evaluator)
    tested = replace(preset, chance_test=True)
    looking = make_context(
        context.dataset,
        tested,
        seed=context.protocol.seed,
        timing=context.protocol.timing,
        limit=context.protocol.limit,
    )
    # What is opened last is what the folder is about.
    first = PairEvaluator(looking, probes(), store, tested, hashing)
    return _Evaluators(first, PairEvaluator(context, chosen, store, preset, hashing))


def _key(evaluators: _Evaluators, chosen: Sequence[Combination], options: RaceOptions) -> str:
    """What the decisions depend on besides measurements; not the budget, which may be raised.

    The keys of rows tell of images, parameters and protocol.
    """
    device = asdict(options.device) if options.device else None
    both = dict.fromkeys((evaluators.overlap, evaluators.race))
    rows = [[row.pair, row.row_key] for evaluator in both for row in evaluator.plan.rows]
    names = [str(each) for each in chosen]
    return content_hash([rows, names, options.objective, options.sure, options.seed, device])
