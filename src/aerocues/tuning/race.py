"""A race for the highest CUES: a cheap look, then more pairs for those that can still win.

The cheapest combinations are measured on a pair of each block. From what is measured a model
tells what to expect of the rest, and how sure that is; tables drawn from it are scored, and the
combinations that come out on top are measured next, the cheaper and less measured ones first
(Thompson sampling; Russo, "Simple Bayesian algorithms for best-arm identification", 2020).
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from aerocues.errors import ScoreError
from aerocues.scoring.objectives import OBJECTIVES, Objective
from aerocues.scoring.settings import ScoreSettings
from aerocues.tuning.criteria_evaluator import Cell, CriteriaEvaluator
from aerocues.tuning.layout import KIND, features, spread_order
from aerocues.tuning.scales import Array, Mask, Scales
from aerocues.tuning.surrogate import Surrogate, fit
from aerocues.tuning.valuation import Valuation, chances, interest_of

Ended = Literal["budget", "sure", "measured"]
FEW = 5
_MOST_BLOCKS = 8
_FEWEST_PAIRS = 2
# Fewer say too little of a winner to end the race early.
_PAIRS_OF_WINNER = 5
# What drawing a table takes a value or feature on a busy machine, until it is seen here; and what
# else follows the last measurement.
_DRAW_SECONDS = 1.6e-7
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
        and everything else that may win on 2.
    look : float
        Share of the budget for a look at each detector and descriptor together.
    cheapest : float
        Share of the alternatives, the cheapest, that are looked at in each block.
    draws, last_draws : int
        Tables drawn in a round, and to tell the chances at the end.
    batch : int
        Measurements of a round.
    score : ScoreSettings
    objective : Objective
        What the best is to be best for.
    """

    budget: float
    seed: int = 0
    sure: float = 1.0
    look: float = 0.4
    cheapest: float = 0.1
    draws: int = 24
    last_draws: int = 400
    batch: int = 16
    score: ScoreSettings = ScoreSettings()  # noqa: RUF009 - it is frozen
    objective: Objective = OBJECTIVES["balanced"]


@dataclass(frozen=True)
class Round:
    """How a race stood after a round.

    Parameters
    ----------
    spent : float
        Seconds.
    measured : int
        Cells.
    contenders : int
        Alternatives that may still be the best or among the few best: in one drawn table at least.
    leader : str
        Whose expected score is the highest, and in what share of the drawn tables it is the best.
    probability : float
    """

    spent: float
    measured: int
    contenders: int
    leader: str
    probability: float


@dataclass(frozen=True, eq=False)
class RaceOutcome:
    """How a race ended.

    Parameters
    ----------
    scores : (A,) float64
        CUES that are expected of a full measurement.
    probability : (A,) float64
        Share of the last draws in which an alternative was the best: on these pairs, for what is
        measured counts as it is.
    known : (A, P) bool
        What was measured.
    ended : {"budget", "sure", "measured"}
        Why: the budget was spent, the leader was sure enough, or all that may win was measured on
        all pairs.
    rounds : list of Round
    """

    scores: Array
    probability: Array
    known: Mask
    ended: Ended
    rounds: list[Round] = field(default_factory=list)

    @property
    def order(self) -> NDArray[np.intp]:
        """Positions of the alternatives, the best first."""
        return np.argsort(-self.scores, kind="stable")


def race(
    evaluator: CriteriaEvaluator,
    settings: RaceSettings,
    told: Callable[[Round], None] | None = None,
    clock: Callable[[], float] = time.monotonic,
) -> RaceOutcome:
    """Run a race; the same evaluator and seed give the same answer.

    Parameters
    ----------
    evaluator : CriteriaEvaluator
    settings : RaceSettings
    told : callable, optional
        Told of each round.
    clock : callable
        Gives seconds, to tell what the end will take.

    Raises
    ------
    ScoreError
        If there is nothing to choose from, or nothing that was looked at succeeded.
    """
    if len(evaluator.alternatives) < 2 or not len(evaluator.blocks):
        raise ScoreError("a race needs two alternatives and a pair; give more")
    return _Race(evaluator, settings, told or (lambda _: None), clock).run()


class _Race:
    def __init__(
        self,
        evaluator: CriteriaEvaluator,
        settings: RaceSettings,
        told: Callable[[Round], None],
        clock: Callable[[], float],
    ) -> None:
        self._evaluator, self._settings, self._told, self._clock = evaluator, settings, told, clock
        self._rng = np.random.default_rng(settings.seed)
        shape = (len(evaluator.alternatives), len(evaluator.blocks))
        self._known = np.zeros(shape, np.bool_)
        self._values = np.full((*shape, len(evaluator.criteria)), np.nan)
        self._is_cost = np.array([each.better == "lower" for each in evaluator.criteria])
        self._features, self._groups = features(evaluator.components)
        self._order = spread_order(evaluator.blocks, self._rng)
        self._rounds: list[Round] = []
        self._draw_seconds = _DRAW_SECONDS * (self._values.size + self._features.size)

    def run(self) -> RaceOutcome:
        self._measure(self._look_at_kinds(), self._settings.look * self._settings.budget)
        self._measure(self._look_at_blocks())
        while True:
            surrogate, scales = self._fit()
            scores, drawn = self._score(surrogate, scales, self._settings.draws)
            interest = interest_of(drawn, FEW)
            leader = int(np.argmax(scores))
            chance = float(chances(drawn)[leader])
            self._tell(leader, chance, int((interest > 0).sum()))
            cells = self._next(interest)
            ended = self._ended(leader, chance, interest, more=bool(cells))
            if ended is not None:
                drawn = self._score(surrogate, scales, self._settings.last_draws)[1]
                probability = chances(drawn)
                doubtful = self._hardly_seen(leader, probability)
                sure = probability[leader] >= self._settings.sure and not doubtful.any()
                if ended != "sure" or sure:
                    return RaceOutcome(scores, probability, self._known, ended, self._rounds)
                cells = self._next(np.where(doubtful, probability, 0.0)) or cells
            self._measure(cells)

    def _tell(self, leader: int, chance: float, contenders: int) -> None:
        name, spent = self._evaluator.alternatives[leader], self._evaluator.spent
        self._rounds.append(Round(spent, int(self._known.sum()), contenders, name, chance))
        self._told(self._rounds[-1])

    def _ended(self, leader: int, chance: float, interest: Array, *, more: bool) -> Ended | None:
        if self._evaluator.spent >= self._settings.budget:
            return "budget"
        if not more:
            return "measured"
        sure = chance >= self._settings.sure < 1.0
        return "sure" if sure and not self._hardly_seen(leader, interest).any() else None

    def _hardly_seen(self, leader: int, interest: Array) -> Mask:
        """(A,) whether the leader or what may win was measured on too few pairs to end early.

        What is measured counts as certain, so that a single lucky pair may look like a sure win.
        """
        counts, pairs = self._known.sum(axis=1), self._known.shape[1]
        enough = np.full(len(counts), min(_FEWEST_PAIRS, pairs))
        enough[leader] = min(_PAIRS_OF_WINNER, pairs)
        return np.asarray((counts < enough) & (interest > 0))

    def _look_at_kinds(self) -> list[Cell]:
        """The cheapest alternative of each detector and descriptor on one pair, cheap ones first.

        What two methods make of each other cannot be told from what they do with others.
        """
        order = np.argsort(self._evaluator.predicted_seconds, kind="stable")
        components = self._evaluator.components
        labels = list(zip(*(components[name] for name in KIND if name in components), strict=True))
        of_each: dict[object, int] = {}
        for each in order:
            of_each.setdefault(labels[each] if labels else each, int(each))
        return [(alternative, int(self._order[0])) for alternative in of_each.values()]

    def _look_at_blocks(self) -> list[Cell]:
        """The cheapest alternatives on a pair of each block."""
        count = max(round(self._settings.cheapest * len(self._known)), 2)
        cheapest = np.argsort(self._evaluator.predicted_seconds, kind="stable")[:count]
        blocks = len(np.unique(self._evaluator.blocks))
        pairs = self._order[: max(min(blocks, _MOST_BLOCKS), _FEWEST_PAIRS)]
        cells = [(int(a), int(p)) for p in pairs for a in cheapest]
        return [cell for cell in cells if not self._known[cell]]

    def _measure(self, cells: Sequence[Cell], limit: float = np.inf) -> None:
        limit = min(limit, self._settings.budget)
        for start in range(0, len(cells), self._settings.batch):
            if start and self._evaluator.spent >= limit:
                return
            batch = cells[start : start + self._settings.batch]
            for (alternative, pair), values in self._evaluator.measure(batch, self._keep()).items():
                self._values[alternative, pair] = values
                self._known[alternative, pair] = True

    def _keep(self) -> float:
        """Seconds that the end takes: the tables of the last round and of the last draws."""
        draws = self._settings.draws + self._settings.last_draws
        return draws * self._draw_seconds + _END_SECONDS

    def _fit(self) -> tuple[Surrogate, Scales]:
        measured = self._values[self._known]
        if not len(measured):
            raise ScoreError("the budget was over before anything was measured; give more")
        if np.isnan(measured).all(axis=0).any():
            raise ScoreError(
                "every combination failed on the first pairs; look whether the images overlap"
            )
        scales = Scales.of(measured, self._is_cost)
        stretched = scales.stretch(self._values)
        blocks = self._evaluator.blocks
        return fit(stretched, self._known, self._features, self._groups, blocks), scales

    def _score(self, surrogate: Surrogate, scales: Scales, draws: int) -> tuple[Array, Array]:
        """Scores (A,) expected, and (draws, A) of drawn tables."""
        settings, evaluator = self._settings, self._evaluator
        began = self._clock()
        whole = scales.shrink(surrogate.expected)
        value = Valuation(
            whole, evaluator.criteria, evaluator.blocks, settings.score, settings.objective
        )
        drawn = []
        for _ in range(draws):
            other = scales.shrink(surrogate.draw(self._rng))
            drawn.append(value.of(np.where(self._known[..., None], whole, other)))
        self._draw_seconds = (self._clock() - began) / draws
        return value.of(whole), np.array(drawn)

    def _next(self, interest: Array) -> list[Cell]:
        """The next pair of those that may win, the cheaper and less measured ones first."""
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
