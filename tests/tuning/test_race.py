from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from aerocues.errors import ScoreError
from aerocues.scoring.criteria import LINKS, Criterion, criteria_named
from aerocues.scoring.cues import score
from aerocues.scoring.objectives import OBJECTIVES
from aerocues.scoring.table import DecisionTable
from aerocues.tuning.race import RaceOutcome, RaceSettings, race
from aerocues.tuning.scales import Scales
from benchmarks.replay import ReplayEvaluator

CRITERIA = (Criterion("precision"), Criterion("inliers"), Criterion("seconds", "lower"))
DETECTORS, DESCRIPTORS, MATCHERS = "abcdef", "uvwxyz", "mn"


def made_up(
    seed: int = 0, pairs: int = 24, blocks: int = 3, failing: float = 0.02
) -> ReplayEvaluator:
    """72 alternatives whose values come from their methods, themselves, blocks and pairs."""
    rng = np.random.default_rng(seed)
    names = [(d, e, m) for d in DETECTORS for e in DESCRIPTORS for m in MATCHERS]
    of = [np.array([group.index(n[i]) for n in names]) for i, group in enumerate(
        (DETECTORS, DESCRIPTORS, MATCHERS))]  # fmt: skip
    quality = rng.normal(0, 0.5, 6)[of[0]] + rng.normal(0, 0.5, 6)[of[1]]
    quality = quality + rng.normal(0, 0.2, len(names))
    block = np.arange(pairs) * blocks // pairs
    there = quality[:, None] + rng.normal(0, 0.3, (len(names), blocks))[:, block]
    there = there + rng.normal(0, 0.4, pairs) + rng.normal(0, 0.15, (len(names), pairs))
    precision = 1 / (1 + np.exp(-there))
    seconds = np.exp(rng.normal(0, 0.8, 6)[of[0]] + rng.normal(0, 0.8, 6)[of[1]] + 0.5 * of[2])
    time = np.tile(seconds[:, None], (1, pairs))
    values = np.stack([precision, 4000 * precision, time / precision], axis=-1)
    values[rng.random((len(names), pairs)) < failing] = np.nan
    components = {
        what: [name[i] for name in names]
        for i, what in enumerate(("detector", "descriptor", "matcher"))
    }
    labels = ["-".join(name) for name in names]
    return ReplayEvaluator(labels, components, CRITERIA, values, block, time, seconds)


def full_scores(evaluator: ReplayEvaluator) -> np.ndarray:
    cells = [
        (a, p) for a in range(len(evaluator.alternatives)) for p in range(len(evaluator.blocks))
    ]
    found = evaluator.measure(cells)
    values = np.array([found[cell] for cell in cells])
    values = values.reshape(len(evaluator.alternatives), len(evaluator.blocks), -1)
    return score(DecisionTable.from_values(values, evaluator.alternatives, CRITERIA)).scores


def run(
    seed: int = 0, share: float = 0.15, **settings: float
) -> tuple[ReplayEvaluator, RaceOutcome]:
    place = made_up()
    chosen = RaceSettings(share * place.total, seed, last_draws=100)
    chosen = replace(chosen, **settings)  # type: ignore[arg-type]
    return place, race(place, chosen)


@pytest.mark.slow
def test_a_race_finds_the_best_for_a_part_of_the_cost() -> None:
    truth = full_scores(made_up())
    regrets = []
    for seed in range(5):
        place, outcome = run(seed)
        assert outcome.ended == "budget"
        assert place.spent < 0.2 * place.total
        regrets.append(truth.max() - truth[outcome.order[0]])
    assert np.median(regrets) < 0.01
    assert max(regrets) < 0.06


def test_what_is_measured_whole_is_scored_as_it_is() -> None:
    place = made_up(pairs=4, blocks=2)
    outcome = race(place, RaceSettings(budget=10 * place.total))
    truth = full_scores(made_up(pairs=4, blocks=2))
    # Once those that can win are measured on all pairs, their order is that of the truth.
    assert outcome.ended == "measured"
    assert outcome.order[0] == int(np.nanargmax(truth))
    assert outcome.probability[outcome.order[0]] >= 0.95


@pytest.mark.slow
def test_a_clear_winner_ends_the_race() -> None:
    place, outcome = run(share=5.0, sure=0.9)
    assert outcome.ended == "sure"
    assert place.spent < place.total
    assert outcome.rounds[-1].probability >= 0.9
    assert outcome.rounds[-1].ranked[0] == place.alternatives[outcome.order[0]]


@pytest.mark.slow
def test_a_race_is_not_sure_of_what_was_hardly_measured() -> None:
    for seed in range(3):
        _, outcome = run(seed, share=5.0, sure=0.5)
        assert outcome.ended == "sure"
        assert outcome.known[outcome.order[0]].sum() >= 5
        rivals = outcome.probability > 0
        assert outcome.known[rivals].sum(axis=1).min() >= 2


@pytest.mark.slow
def test_the_same_seed_gives_the_same_race() -> None:
    first, second = run(3)[1], run(3)[1]
    np.testing.assert_array_equal(first.scores, second.scores)
    np.testing.assert_array_equal(first.known, second.known)
    assert first.rounds == second.rounds
    assert (run(4)[1].known != first.known).any()


def test_the_first_look_sees_every_block() -> None:
    _, outcome = run(share=0.02)
    seen = outcome.known.any(axis=0).reshape(3, 8)
    assert seen.any(axis=1).all()


def turned_strips() -> ReplayEvaluator:
    """36 alternatives on 24 pairs, six of them turned: half are better, and fail on turned ones."""
    names = [f"{d}-{e}" for d in DETECTORS for e in DESCRIPTORS]
    upright = np.array([name[-1] in "uvw" for name in names])
    turned = np.arange(24) % 4 == 3
    random = np.random.default_rng(0)
    precision = np.where(upright, 0.8, 0.5)[:, None] + random.normal(0, 0.05, (36, 24))
    links = np.where(upright, 1.0, 0.7)[:, None] + np.zeros((36, 24))
    values = np.stack([precision, links], axis=-1)
    values[upright[:, None] & turned] = np.nan
    components = {"detector": [n[0] for n in names], "descriptor": [n[-1] for n in names]}
    criteria = criteria_named(("ref_precision@3", LINKS))
    seconds = random.uniform(0.5, 1.5, 36)
    evaluator = ReplayEvaluator(
        *(names, components, criteria, values, np.zeros(24, np.int64)),
        *(np.tile(seconds[:, None], (1, 24)), seconds),
    )
    evaluator.classes = turned.astype(np.int64)
    return evaluator


@pytest.mark.parametrize("seed", range(6))
def test_what_fails_on_few_turned_pairs_does_not_lead(seed: int) -> None:
    evaluator = turned_strips()
    chosen = RaceSettings(0.12 * evaluator.total, seed, objective=OBJECTIVES["reconstruction"])
    outcome = race(evaluator, chosen)
    first = [evaluator.alternatives[place][-1] for place in outcome.order[:5]]
    assert not set(first) & set("uvw")


def test_nothing_to_choose_from_and_nothing_that_works() -> None:
    place = made_up(failing=1.1)
    with pytest.raises(ScoreError):
        race(place, RaceSettings(budget=1.0))
    lonely = made_up()
    lonely.alternatives = ["a-u-m"]
    with pytest.raises(ScoreError, match="two"):
        race(lonely, RaceSettings(budget=1.0))


def test_sharing_costs_once() -> None:
    place = made_up()
    place.measure([(0, 0)])
    alone = place.spent
    place.measure([(1, 0)])  # the same detector and descriptor, another matcher
    assert place.spent - alone < 0.7 * alone * np.exp(0.5)
    again = made_up()
    full_scores(again)
    assert again.spent == pytest.approx(again.total)


@settings(max_examples=30)
@given(st.integers(0, 2**32 - 1), st.floats(1e-3, 1e6))
def test_values_come_back_from_their_scales(seed: int, size: float) -> None:
    rng = np.random.default_rng(seed)
    values = np.column_stack([rng.random(20), size * rng.random(20) + 1e-3 * size])
    scales = Scales.of(values, np.array([False, True]))
    np.testing.assert_allclose(scales.shrink(scales.stretch(values)), values, rtol=1e-6)
    failed = scales.shrink(scales.stretch(np.full((1, 2), np.nan)))
    np.testing.assert_allclose(failed[0], [0.0, values[:, 1].max()], rtol=1e-6, atol=1e-12)


def test_what_is_given_is_known_from_the_start() -> None:
    place = made_up(pairs=4, blocks=2)
    cells = [(a, p) for a in range(len(place.alternatives)) for p in range(4)]
    known = made_up(pairs=4, blocks=2).measure(cells)
    outcome = race(place, RaceSettings(budget=10 * place.total), given=known)
    assert outcome.known.all()
    assert (outcome.ended, len(outcome.rounds)) == ("measured", 1)
    assert outcome.order[0] == int(np.nanargmax(full_scores(made_up(pairs=4, blocks=2))))
