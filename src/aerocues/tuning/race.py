"""A race for the highest CUES: cheap first measurements, then more pairs for likely winners.

First the cheapest combinations are measured on a pair of each block and class. A model then
predicts the values that were not measured, with their uncertainty. Tables are drawn from it and
scored, and the combinations that win some of these tables are measured next, the cheaper and less
measured ones first (Thompson sampling; Russo, "Simple Bayesian algorithms for best-arm
identification", 2020).
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from aerocues.errors import ScoreError
from aerocues.scoring.objectives import OBJECTIVES, Objective
from aerocues.scoring.settings import ScoreSettings
from aerocues.scoring.valuation import Valuation, chances, interest_of
from aerocues.tuning.criteria_evaluator import Cell, CriteriaEvaluator
from aerocues.tuning.layout import KIND, features, kinds_of_pairs, spread_order
from aerocues.tuning.scales import Array, Mask, Scales
from aerocues.tuning.surrogate import Surrogate, fit

Ended = Literal["budget", "sure", "measured"]
# Users see the best five: what is likely to be among them is worth measuring, too.
FEW = 5
# Blocks in the first measurements: more cover more scenes, but delay the race.
_MOST_BLOCKS = 8
# Pairs that a possible winner needs before the race may end early: measured values count as
# certain, so that a single lucky pair looks like a sure win. More are safer and take longer.
_FEWEST_PAIRS, _PAIRS_OF_WINNER = 2, 5
# Seconds to draw a table, per value and feature, until the first round was timed. Too high a guess
# ends a short race early, too low a one exceeds the budget.
_DRAW_SECONDS = 1.6e-7
# Seconds for everything else after the last measurement, such as the tables of the answer.
_END_SECONDS = 1.0


@dataclass(frozen=True)
class RaceSettings:
    """How a race is run.

    Parameters
    ----------
    budget : float
        Seconds, as the evaluator counts them.
    seed : int
    sure : float
        Probability of the leader at which the race ends, once the leader was measured on 5 pairs
        and every other possible winner on 2.
    first_share : float
        Share of the budget for the first measurement of each detector-descriptor pair. Interactions
        of two methods cannot be predicted from other combinations; a larger share finds more of
        them, and leaves less time to compare the best.
    cheapest : float
        Share of the alternatives, the cheapest, that are measured in each block before the race:
        a larger share gives the model more data, and delays the race.
    draws, last_draws : int
        Tables drawn in each round, and for the probabilities at the end. Their error falls with the
        square root of the number: 24 tell roughly who can win, 400 give probabilities to about 2.5
        percentage points.
    batch : int
        Measurements of a round: more keep more workers busy, fewer follow the model more closely.
    score : ScoreSettings
    objective : Objective
        Decides which score the best combination maximises.
    """

    budget: float
    seed: int = 0
    sure: float = 1.0
    first_share: float = 0.4
    cheapest: float = 0.1
    draws: int = 24
    last_draws: int = 400
    batch: int = 16
    score: ScoreSettings = ScoreSettings()  # noqa: RUF009 - it is frozen
    objective: Objective = OBJECTIVES["efficiency"]


@dataclass(frozen=True)
class Round:
    """The state of a race after a round.

    Parameters
    ----------
    spent, measured : float, int
        Seconds, and cells.
    contenders : int
        Alternatives that are among the `FEW` best in at least one drawn table.
    ranked : sequence of str
        All alternatives, the highest expected score first.
    probability : float
        Share of the drawn tables that the first of them wins.
    """

    spent: float
    measured: int
    contenders: int
    ranked: Sequence[str]
    probability: float


@dataclass(frozen=True, eq=False)
class RaceOutcome:
    """The result of a race.

    Parameters
    ----------
    scores : (A,) float64
        Expected CUES of a full measurement.
    probability : (A,) float64
        Share of the last drawn tables in which an alternative is the best. It holds for these
        pairs: measured values count as certain.
    known : (A, P) bool
        Which cells were measured.
    ended : {"budget", "sure", "measured"}
        Why the race ended: the budget was spent, the leader was sure enough, or all possible
        winners were measured on all pairs.
    rounds : list of Round
    """

    scores: Array
    probability: Array
    known: Mask
    ended: Ended
    rounds: list[Round] = field(default_factory=list)

    @property
    def order(self) -> NDArray[np.intp]:
        """Indices of the alternatives, the best first."""
        return np.argsort(-self.scores, kind="stable")


def race(
    evaluator: CriteriaEvaluator,
    settings: RaceSettings,
    on_round: Callable[[Round], None] = lambda _: None,
    clock: Callable[[], float] = time.monotonic,
    given: Mapping[Cell, Array] = MappingProxyType({}),
) -> RaceOutcome:
    """Run a race; the same evaluator, seed and given values give the same result.

    Parameters
    ----------
    evaluator : CriteriaEvaluator
    settings : RaceSettings
    on_round : callable
        Called with each finished round.
    clock : callable
        Returns seconds, to measure how long drawing takes.
    given : mapping of Cell to (C,) float64
        Values that are known from the start.

    Raises
    ------
    ScoreError
        If there are fewer than two alternatives or no pair, or all first measurements failed.
    """
    if len(evaluator.alternatives) < 2 or not len(evaluator.blocks):
        raise ScoreError("a race needs at least two alternatives and one pair")
    return _Race(evaluator, settings, on_round, clock).run(given)


class _Race:
    def __init__(
        self,
        evaluator: CriteriaEvaluator,
        settings: RaceSettings,
        on_round: Callable[[Round], None],
        clock: Callable[[], float],
    ) -> None:
        self._evaluator, self._settings = evaluator, settings
        self._on_round, self._clock = on_round, clock
        self._rng = np.random.default_rng(settings.seed)
        shape = (len(evaluator.alternatives), len(evaluator.blocks))
        self._known = np.zeros(shape, np.bool_)
        self._values = np.full((*shape, len(evaluator.criteria)), np.nan)
        self._is_cost = np.array([each.better == "lower" for each in evaluator.criteria])
        self._features, self._groups = features(evaluator.components)
        self._kinds = kinds_of_pairs(evaluator.blocks, evaluator.classes)
        self._order = spread_order(self._kinds, self._rng)
        self._rounds: list[Round] = []
        self._draw_seconds = _DRAW_SECONDS * (self._values.size + self._features.size)

    def run(self, given: Mapping[Cell, Array]) -> RaceOutcome:
        self._learn(given)
        self._measure(self._one_per_kind(), self._settings.first_share * self._settings.budget)
        self._measure(self._cheapest_per_block())
        while True:
            surrogate, scales = self._fit()
            scores, drawn = self._score(surrogate, scales, self._settings.draws)
            interest = interest_of(drawn, FEW)
            leader = int(np.argmax(scores))
            chance = float(chances(drawn)[leader])
            self._report(scores, chance, int((interest > 0).sum()))
            cells = self._next(interest)
            ended = self._ended(leader, chance, interest, more=bool(cells))
            if ended is not None:
                drawn = self._score(surrogate, scales, self._settings.last_draws)[1]
                probability = chances(drawn)
                doubtful = self._hardly_measured(leader, probability)
                sure = probability[leader] >= self._settings.sure and not doubtful.any()
                if ended != "sure" or sure:
                    return RaceOutcome(scores, probability, self._known, ended, self._rounds)
                cells = self._next(np.where(doubtful, probability, 0.0)) or cells
            self._measure(cells)

    def _report(self, scores: Array, chance: float, contenders: int) -> None:
        ranked = [self._evaluator.alternatives[each] for each in np.argsort(-scores, kind="stable")]
        spent, measured = self._evaluator.spent, int(self._known.sum())
        self._rounds.append(Round(spent, measured, contenders, ranked, chance))
        self._on_round(self._rounds[-1])

    def _ended(self, leader: int, chance: float, interest: Array, *, more: bool) -> Ended | None:
        if self._evaluator.spent >= self._settings.budget:
            return "budget"
        if not more:
            return "measured"
        sure = chance >= self._settings.sure < 1.0
        return "sure" if sure and not self._hardly_measured(leader, interest).any() else None

    def _hardly_measured(self, leader: int, interest: Array) -> Mask:
        """(A,) whether a possible winner was measured on too few pairs to end the race early."""
        counts, pairs = self._known.sum(axis=1), self._known.shape[1]
        enough = np.full(len(counts), min(_FEWEST_PAIRS, pairs))
        enough[leader] = min(_PAIRS_OF_WINNER, pairs)
        return np.asarray((counts < enough) & (interest > 0))

    def _one_per_kind(self) -> list[Cell]:
        """The cheapest alternative of each detector-descriptor pair on one pair, cheap ones first.

        How well two methods work together cannot be predicted from other combinations.
        """
        order = np.argsort(self._evaluator.predicted_seconds, kind="stable")
        components = self._evaluator.components
        labels = list(zip(*(components[name] for name in KIND if name in components), strict=True))
        of_each: dict[object, int] = {}
        for each in order:
            of_each.setdefault(labels[each] if labels else each, int(each))
        return [(alternative, int(self._order[0])) for alternative in of_each.values()]

    def _cheapest_per_block(self) -> list[Cell]:
        """The cheapest alternatives on a pair of each block."""
        count = max(round(self._settings.cheapest * len(self._known)), 2)
        cheapest = np.argsort(self._evaluator.predicted_seconds, kind="stable")[:count]
        kinds = len(np.unique(self._kinds))
        pairs = self._order[: max(min(kinds, _MOST_BLOCKS), _FEWEST_PAIRS)]
        cells = [(int(a), int(p)) for p in pairs for a in cheapest]
        return [cell for cell in cells if not self._known[cell]]

    def _measure(self, cells: Sequence[Cell], limit: float = np.inf) -> None:
        limit = min(limit, self._settings.budget)
        for start in range(0, len(cells), self._settings.batch):
            if start and self._evaluator.spent >= limit:
                return
            batch = cells[start : start + self._settings.batch]
            self._learn(self._evaluator.measure(batch, self._keep()))

    def _learn(self, values: Mapping[Cell, Array]) -> None:
        for cell, own in values.items():
            self._values[cell], self._known[cell] = own, True

    def _keep(self) -> float:
        """Seconds to reserve for the end: the tables of the last round and of the last draws."""
        draws = self._settings.draws + self._settings.last_draws
        return draws * self._draw_seconds + _END_SECONDS

    def _fit(self) -> tuple[Surrogate, Scales]:
        measured = self._values[self._known]
        if not len(measured):
            raise ScoreError("the budget was spent before anything was measured; give more time")
        if np.isnan(measured).all(axis=0).any():
            raise ScoreError(
                "every combination failed on the first pairs; check that the images overlap"
            )
        scales = Scales.of(measured, self._is_cost)
        stretched = scales.stretch(self._values)
        return fit(stretched, self._known, self._features, self._groups, self._kinds), scales

    def _score(self, surrogate: Surrogate, scales: Scales, draws: int) -> tuple[Array, Array]:
        """(A,) expected scores, and (draws, A) scores of drawn tables."""
        settings, evaluator = self._settings, self._evaluator
        began = self._clock()
        whole = scales.shrink(surrogate.expected)
        value = Valuation(
            whole,
            evaluator.criteria,
            evaluator.blocks,
            settings.score,
            settings.objective,
            classes=evaluator.classes,
        )
        drawn = []
        for _ in range(draws):
            other = scales.shrink(surrogate.draw(self._rng))
            drawn.append(value.of(np.where(self._known[..., None], whole, other)))
        self._draw_seconds = (self._clock() - began) / draws
        return value.of(whole), np.array(drawn)

    def _next(self, interest: Array) -> list[Cell]:
        """The next pair of each possible winner, the cheaper and less measured ones first."""
        counts = self._known.sum(axis=1)
        seconds = np.maximum(self._evaluator.predicted_seconds, 1e-9)
        worth = interest / np.sqrt((counts + 1.0) * seconds)
        chosen: list[Cell] = []
        for alternative in np.argsort(-worth, kind="stable"):
            left = [pair for pair in self._order if not self._known[alternative, pair]]
            if worth[alternative] > 0 and left:
                chosen.append((int(alternative), int(left[0])))
            if worth[alternative] <= 0 or len(chosen) == self._settings.batch:
                break
        return chosen
