"""A race of combinations on images: representative pairs, equal footing, an answer."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from aerocues.arguments import check_choice, check_number, check_whole
from aerocues.datasets.dataset import Dataset, Image, Pair
from aerocues.defaults import FLIGHT_KEYPOINTS, RACE_PAIRS, RACE_SECONDS, SURE
from aerocues.errors import SelectionError
from aerocues.evaluation.context import make_context
from aerocues.evaluation.run import local_engine
from aerocues.evaluation.unit import Context
from aerocues.methods.combination import Combination
from aerocues.methods.presets import Preset, as_preset
from aerocues.methods.selection import Patterns, select
from aerocues.methods.strongest import keypoint_limit
from aerocues.pipeline.equal_footing import at_equal_footing
from aerocues.pipeline.feature_folder import checked_folder
from aerocues.pipeline.flight_pairs import SurveyedFlight, survey_flight
from aerocues.pipeline.upright import turned_upright
from aerocues.progress import Progress
from aerocues.results.hashing import content_hash
from aerocues.results.store import RACE, Store
from aerocues.scoring.criteria import criteria_named
from aerocues.scoring.objectives import OBJECTIVES, Objective
from aerocues.scoring.settings import ScorePreset
from aerocues.tuning.device import Device
from aerocues.tuning.image_evaluator import ImageEvaluator
from aerocues.tuning.journal import Journal
from aerocues.tuning.kept_features import has_room, keep_best
from aerocues.tuning.pair_evaluator import PairEvaluator
from aerocues.tuning.race import RaceSettings, Round, race
from aerocues.tuning.race_progress import RaceProgress
from aerocues.tuning.race_ranking import race_ranking
from aerocues.tuning.recommendation import Recommendation
from aerocues.tuning.representative import FEWEST_PAIRS, Seen, find_overlap, probes, spread_pairs
from aerocues.tuning.session import Session


@dataclass(frozen=True)
class RaceOptions:
    """What is raced for, and how long; see `aerocues.recommend`.

    ``features`` is a folder within the results, in which the features of the best are kept; by
    default none are.
    """

    budget: float = RACE_SECONDS
    objective: str = "balanced"
    sure: float = SURE
    max_pairs: int = RACE_PAIRS
    seed: int = 0
    device: Device | None = None
    features: str | None = None

    def __post_init__(self) -> None:
        check_choice("objective", self.objective, OBJECTIVES)
        check_number("sure", self.sure, 0.5, 1.0)
        check_whole("max_pairs", self.max_pairs, FEWEST_PAIRS)
        check_whole("seed", self.seed, 0)

    def settings(self, objective: Objective, scoring: ScorePreset) -> RaceSettings:
        """Of the race itself."""
        return RaceSettings(
            self.budget, self.seed, sure=self.sure, score=scoring.settings, objective=objective
        )


def recommend_by_race(
    dataset: Dataset,
    combinations: Patterns | None,
    output: str | Path | None,
    options: RaceOptions,
    *,
    max_keypoints: int = FLIGHT_KEYPOINTS,
    preset: str | Preset = "default",
    upright: bool = False,
    workers: int | None = None,
    began: float | None = None,
    progress: Progress | None = None,
) -> Recommendation:
    """Find the combination that suits images best by their pairs, within a budget of time.

    Pairs are chosen that stand for all; those that show nothing in common are left out. Then
    combinations race: all that are cheap are looked at, and more pairs are measured of those that
    can still win, until one is sure enough to be the best or the budget is spent.

    Parameters
    ----------
    dataset : Dataset
    combinations, output, max_keypoints, preset, upright, workers, began, progress
        As in `aerocues.recommend`.
    options : RaceOptions

    Returns
    -------
    Recommendation
        Without a final.

    Raises
    ------
    AerocuesError
        If an argument makes no sense, the images show nothing in common, nothing succeeds, or
        budget or choice are too small.
    """
    began = time.monotonic() if began is None else began
    seconds, machine, seed = options.budget, options.device, options.seed
    limit, parts = keypoint_limit(max_keypoints), as_preset(preset)
    engine_here = local_engine("estimated", workers)
    context = make_context(dataset, parts, seed=seed, timing="estimated", limit=limit)
    chosen = _chosen(context, combinations)
    store = Store.create(Path(output or f"{dataset.name}-race"))
    begun_before = (store.folder / RACE).exists()
    tell = RaceProgress(progress, seconds, began, strict=not begun_before)
    dataset, flight = _surveyed(dataset, options, tell, store, upright=upright)
    part = flight.dataset if flight else _spread(dataset, options.max_pairs, seed)
    pairs = part.pairs
    reached = tell.preparing("setting thresholds", "detectors", alike=False)
    parts, footings = at_equal_footing(
        context.methods, parts, part.images, chosen, limit, seed=seed, progress=reached
    )
    context = make_context(part, parts, seed=seed, timing="estimated", limit=limit)
    kept = _kept_features(store, options)
    context = replace(context, references=store.references, features=kept)
    with store.writing(), engine_here.standing(context) as engine:
        evaluators = _evaluators(context, chosen, store, parts, tell.read)
        key, there = _key(evaluators, chosen, options), evaluators.race.there
        journal = Journal.read(store.folder, key, seconds, there)
        tell.resumed(journal.spent)
        session = Session(journal, began=began, watch=tell.watch)
        tell.looking(len(pairs))
        with engine_here.standing(evaluators.overlap.context) as other:
            own = engine if evaluators.overlap is evaluators.race else other
            seen = find_overlap(evaluators.overlap, own, pairs, session, seed)
        aim = OBJECTIVES[options.objective]
        seen = _raceable(seen, evaluators.race, parts, surveyed=flight is not None)
        scoring = aim.scoring(references=bool(seen.referenced), chance_test=parts.chance_test)
        raced = seen.referenced or seen.overlapping
        tell.racing(len(chosen), len(raced))
        criteria = criteria_named(aim.criteria(scoring))
        evaluator = ImageEvaluator(
            evaluators.race, engine, chosen, raced, criteria, session, machine
        )
        if flight:
            evaluator.classes = flight.classes_of(raced)
        settings = options.settings(aim, scoring)
        outcome = race(evaluator, settings, _after_rounds(tell, kept), given=evaluator.given())
    return Recommendation(
        part,
        seen,
        len(dataset.pairs),
        aim,
        outcome,
        race_ranking(evaluators.race, chosen, raced, outcome, machine),
        len(chosen),
        int(outcome.known.any(axis=1).sum()),
        store.folder,
        machine.name if machine else context.machine,
        parts,
        tuple(footings),
        flight,
    )


def _kept_features(store: Store, options: RaceOptions) -> Path | None:
    """The folder of features, if any are to be kept and the disk has room for them."""
    if options.features is None or not has_room(store.folder):
        return None
    return checked_folder((store.folder / options.features).absolute())


def _after_rounds(tell: RaceProgress, kept: Path | None) -> Callable[[Round], None]:
    """What is done after each round of a race."""

    def after(finished: Round) -> None:
        tell.round(finished)
        if kept:
            keep_best(kept, finished.ranked)

    return after


def _surveyed(
    dataset: Dataset, options: RaceOptions, tell: RaceProgress, store: Store, *, upright: bool
) -> tuple[Dataset, SurveyedFlight | None]:
    """The images, turned if that is asked for, and their representative pairs."""
    surveyed = tell.preparing("surveying the flight", "images and pairs")
    if upright:
        dataset = turned_upright(dataset, options.seed, surveyed, store.surveys)
        tell.note(dataset.notes[-1])
    pairs = survey_flight(dataset, options.max_pairs, options.seed, surveyed, store.surveys)
    return dataset, pairs


def _raceable(seen: Seen, evaluator: PairEvaluator, preset: Preset, *, surveyed: bool) -> Seen:
    """The pairs to race on: those that a survey saw overlap, and that may have a reference."""
    if surveyed:  # what there was no time to test overlaps, too
        seen = replace(seen, overlapping=(*seen.overlapping, *seen.unseen), unseen=())
    if not preset.chance_test:
        return seen
    lacking = evaluator.without_reference()
    return replace(seen, referenced=tuple(p for p in seen.overlapping if p not in lacking))


def _spread(dataset: Dataset, most: int, seed: int) -> Dataset:
    """A dataset with a part of its pairs, spread over it, and the images that they need."""
    pairs = spread_pairs(dataset.pairs, most, seed)
    return replace(dataset, pairs=pairs, images=_used(dataset, pairs))


def _used(dataset: Dataset, pairs: Sequence[Pair]) -> list[Image]:
    names = {name for pair in pairs for name in (pair.image_1, pair.image_2)}
    return [image for image in dataset.images if image.name in names]


def _chosen(context: Context, combinations: Patterns | None) -> list[Combination]:
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
    looking = replace(looking, references=context.references)
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
