"""Searches a space of settings on training pairs, and validates the best on other pairs."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from aerocues.evaluation.engine import Engine
from aerocues.pipeline.reference import FLOW
from aerocues.progress import Activity
from aerocues.results.metrics import Row
from aerocues.scoring.criteria import RIGHT_MATCHES
from aerocues.tuning.grids import Setting
from aerocues.tuning.image_evaluator import criterion_values, rows_frame
from aerocues.tuning.pair_evaluator import PairEvaluator
from aerocues.tuning.scales import Array
from aerocues.tuning.search_objective import SearchObjective, mean_gain, threshold_objective
from aerocues.tuning.search_spaces import SearchSpace
from aerocues.tuning.splits import Split

# Successive halving for grids larger than this: all candidates on a third of the pairs, the better
# third of them on the rest. Smaller shares save time, and discard the best candidate more often.
LARGE_GRID = 9
FIRST_PART = 0.34
KEPT = 0.34
FEWEST_PAIRS, FEWEST_KEPT = 3, 4
FEWEST_TO_JUDGE = 3
"""Validation pairs: with two, any test takes chance gains as proof too often."""
NO_REFERENCE = "too few pairs have a reference of right matches; choose another objective"


@dataclass(frozen=True)
class Figures:
    """Mean figures of a candidate over pairs; a failed pair counts as 0.

    Right matches and their share are by the reference, None without one; the share and the median
    of the seconds are of the pairs that have them.
    """

    success: float
    inliers: float
    right_matches: float | None
    right_share: float | None
    seconds: float | None


@dataclass(frozen=True)
class JudgedBy:
    """Numbers of validation pairs and of their scenes."""

    pairs: int
    scenes: int


@dataclass(frozen=True)
class Finding:
    """The result of a search.

    Parameters
    ----------
    space : SearchSpace
    tried : int
        Number of candidates, including the default.
    best : mapping
        The best setting on the training pairs; empty for the default.
    gain, low, high : float
        Gain in score over the default on validation pairs, with its 95 % interval; 0 for the
        default.
    default, tuned : Figures or None
        Figures on validation pairs.
    pays : bool
        Whether the setting is kept.
    why_not : str
        Why it is not kept.
    judged_by : JudgedBy or None
        None for the default.
    """

    space: SearchSpace
    tried: int
    best: Setting
    gain: float
    low: float
    high: float
    default: Figures | None
    tuned: Figures | None
    pays: bool
    why_not: str = ""
    judged_by: JudgedBy | None = None


@dataclass(frozen=True)
class TuningDataset:
    """A dataset of a search: its evaluator, engine and split."""

    evaluator: PairEvaluator
    engine: Engine
    split: Split


class Search:
    """Searches one space after the other.

    Parameters
    ----------
    datasets : sequence of TuningDataset
    objective : SearchObjective
    seed : int
    deadline : float
        In seconds of `time.monotonic`; methods that are not finished then keep their default.
    watch : callable
        Called with the activities of the workers.
    """

    def __init__(
        self,
        datasets: Sequence[TuningDataset],
        objective: SearchObjective,
        seed: int,
        deadline: float = float("inf"),
        watch: Callable[[Sequence[Activity]], None] = lambda _: None,
    ) -> None:
        self._datasets, self._objective, self._seed = datasets, objective, seed
        self._deadline, self._watch = deadline, watch

    def run(self, space: SearchSpace) -> Finding:
        """Search one space."""
        objective = threshold_objective() if space.kind == "threshold" else self._objective
        training, judging = self._pairs(space, "training"), self._pairs(space, "validation")
        if space.kind == "threshold" and not (training and judging):
            return _kept(space, 0, "no ground truth to validate thresholds")
        if len(judging) < FEWEST_TO_JUDGE:
            return _kept(space, 0, f"fewer than {FEWEST_TO_JUDGE} validation pairs")
        candidates = list(range(len(space.settings)))
        if len(candidates) > LARGE_GRID:
            part = training[: max(round(FIRST_PART * len(training)), FEWEST_PAIRS)]
            telling, values = self._values(space, candidates, part, objective)
            if telling:  # they choose; else all are measured on all pairs
                candidates = _better_third(objective.scores(values))
        training, values = self._values(space, candidates, training, objective)
        if time.monotonic() >= self._deadline:
            return _kept(space, len(space.settings), "time was up")
        if not training:
            return _kept(space, len(space.settings), NO_REFERENCE)
        if np.isnan(values).all():
            return _kept(space, len(space.settings), "everything failed")
        best = candidates[int(np.argmax(objective.scores(values)))]
        if not best:
            return _kept(space, len(space.settings), "the default is the best")
        return self._judged(space, best, judging, values, objective)

    def _judged(
        self,
        space: SearchSpace,
        best: int,
        pairs: Sequence[tuple[int, int]],
        training: Array,
        objective: SearchObjective,
    ) -> Finding:
        pairs, values = self._values(space, [0, best], pairs, objective)
        setting, tried = space.settings[best], len(space.settings)
        if time.monotonic() >= self._deadline:
            return _kept(space, tried, "time was up")
        if len(pairs) < FEWEST_TO_JUDGE:
            return _kept(space, tried, NO_REFERENCE)
        first, second = objective.on_others(training, values)
        scenes = [self._scene(each) for each in pairs]
        gain, low, high = mean_gain(second - first, scenes)
        default, tuned = (self._figures(space, each, pairs) for each in (0, best))
        why_not = ""
        if low <= 0:
            why_not = "the gain is not significant on validation pairs"
        elif gain < objective.least_gain(first):
            why_not = "the gain is too small to matter"
        judged_by = JudgedBy(len(pairs), len(set(scenes)))
        pays, figures = not why_not, (gain, low, high, default, tuned)
        return Finding(space, tried, setting, *figures, pays, why_not, judged_by)

    def _pairs(self, space: SearchSpace, side: str) -> list[tuple[int, int]]:
        """Position of the dataset and number of each usable pair, in random order."""
        pairs = [
            (number, pair)
            for number, dataset in enumerate(self._datasets)
            for pair in getattr(dataset.split, side)
        ]
        order = np.random.default_rng(self._seed).permutation(len(pairs))
        mixed = [pairs[place] for place in order]
        return [each for each in mixed if space.kind != "threshold" or self._has_truth(each)]

    def _scene(self, pair: tuple[int, int]) -> tuple[int, str]:
        return pair[0], self._datasets[pair[0]].evaluator.context.dataset.pair(pair[1]).sequence

    def _has_truth(self, pair: tuple[int, int]) -> bool:
        dataset = self._datasets[pair[0]].evaluator.context.dataset
        images = dataset.pair(pair[1])
        return images.homography is not None or dataset.true_views(images) is not None

    def _measure(
        self, space: SearchSpace, candidates: Sequence[int], pairs: Sequence[tuple[int, int]]
    ) -> None:
        """Measure what is missing of each candidate on each pair."""
        named = [space.variant(candidate) for candidate in candidates]
        for number, dataset in enumerate(self._datasets):
            asked = [
                (pair, each)
                for place, pair in pairs
                if place == number
                for each in named
                if dataset.evaluator.possible((pair, each))
            ]
            dataset.evaluator.measure(
                asked, dataset.engine, deadline=self._deadline, watch=self._watch
            )

    def _rows(
        self, space: SearchSpace, candidates: Sequence[int], pairs: Sequence[tuple[int, int]]
    ) -> list[Row | None]:
        """Measured rows of each candidate on each pair, candidate after candidate."""
        return [
            self._datasets[place].evaluator.row((pair, space.variant(candidate)))
            for candidate in candidates
            for place, pair in pairs
        ]

    def _values(
        self,
        space: SearchSpace,
        candidates: Sequence[int],
        pairs: Sequence[tuple[int, int]],
        objective: SearchObjective,
    ) -> tuple[list[tuple[int, int]], Array]:
        """Pairs that tell, and (A, P, C) values; NaN where one failed or was not measured."""
        self._measure(space, candidates, pairs)
        pairs = self._telling(pairs, objective)
        rows = self._rows(space, candidates, pairs)
        values = np.full((len(rows), len(objective.criteria)), np.nan)
        known = [place for place, row in enumerate(rows) if row is not None]
        if known:
            values[known] = criterion_values(
                [row for row in rows if row is not None], objective.criteria
            )
        return pairs, values.reshape(len(candidates), len(pairs), len(objective.criteria))

    def _telling(
        self, pairs: Sequence[tuple[int, int]], objective: SearchObjective
    ) -> list[tuple[int, int]]:
        """Pairs that tell candidates apart: without a reference, no match is known to be right."""
        if not objective.reference:
            return list(pairs)
        silent = [dataset.evaluator.without_reference() for dataset in self._datasets]
        return [each for each in pairs if each[1] not in silent[each[0]]]

    def _figures(
        self, space: SearchSpace, candidate: int, pairs: Sequence[tuple[int, int]]
    ) -> Figures:
        import polars as pl

        rows = [row for row in self._rows(space, [candidate], pairs) if row is not None]
        table = rows_frame(rows)
        ok, referenced = pl.col("status") == "ok", (table["reference"] == FLOW).any()
        right = pl.when(ok).then(pl.col(RIGHT_MATCHES)).fill_null(0.0).mean()
        row = table.select(
            ok.mean().alias("success"),
            pl.when(ok).then(pl.col("excess_inliers")).otherwise(0.0).mean().alias("inliers"),
            right.alias("right") if referenced else pl.lit(None).alias("right"),
            pl.col("ref_precision@3").mean(),
            pl.col("total_seconds").median(),
        ).row(0)
        return Figures(*row)


def _better_third(scores: Array) -> list[int]:
    """The default, and the candidates of the highest scores."""
    count = max(round(KEPT * len(scores)), FEWEST_KEPT)
    return sorted({0, *(int(each) for each in np.argsort(-scores, kind="stable")[:count])})


def _kept(space: SearchSpace, tried: int, why_not: str) -> Finding:
    return Finding(space, tried, {}, 0.0, 0.0, 0.0, None, None, pays=False, why_not=why_not)
