"""The time budget of a race, and its measurements step by step."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

from aerocues.errors import SelectionError
from aerocues.evaluation.engine import Engine
from aerocues.progress import Activity
from aerocues.tuning.journal import Journal, Step
from aerocues.tuning.pair_evaluator import Measurement, PairEvaluator

# The suggested budget over one that was too small. A smaller factor often fails again, a larger one
# makes users wait longer than needed.
MORE = 3.0
BUDGETS = (10, 20, 30, 60, 120, 300, 600, 1200, 1800, 3600)


class Session:
    """Measures within a budget of wall time.

    The steps that the journal has of an interrupted race are replayed without measuring, so that
    the same decisions are made.

    Parameters
    ----------
    journal : Journal
    began : float, optional
        Start time in seconds of `clock`; now by default.
    watch : callable, optional
        Called with the activities of the workers.
    clock : callable, optional
        Returns seconds.
    """

    def __init__(
        self,
        journal: Journal,
        *,
        began: float | None = None,
        watch: Callable[[Sequence[Activity]], None] = lambda _: None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.budget = journal.budget
        self._journal, self._watch, self._clock = journal, watch, clock
        self._began = (clock() if began is None else began) - journal.spent
        self.spent = 0.0 if journal.steps else clock() - self._began
        """Seconds so far, including those reserved for the end."""

    @property
    def given(self) -> frozenset[str]:
        """Keys of the rows that were there when the race began."""
        return self._journal.given

    def measure(
        self,
        evaluator: PairEvaluator,
        engine: Engine,
        asked: Sequence[Measurement],
        *,
        until: float = float("inf"),
        keep: float = 0.0,
    ) -> frozenset[str]:
        """Measure what is missing, and return the keys of rows that were not finished in time.

        Parameters
        ----------
        evaluator : PairEvaluator
        engine : Engine
        asked : sequence of Measurement
        until : float
            Seconds of the budget after which unfinished rows are dropped; all by default.
        keep : float
            Seconds of the budget that are reserved for the time after the last step.
        """
        keys = [evaluator.row_key(each) for each in asked]
        there = [
            key for key, each in zip(keys, asked, strict=True) if evaluator.row(each) is not None
        ]
        step = self._journal.replay(keys, there)
        if step is None:
            step = self._work(evaluator, engine, asked, min(until, self.budget - keep), keep)
        self.spent = step.spent + step.kept
        return frozenset(step.missing)

    def _work(
        self,
        evaluator: PairEvaluator,
        engine: Engine,
        asked: Sequence[Measurement],
        until: float,
        keep: float,
    ) -> Step:
        finished = False
        try:
            evaluator.measure(asked, engine, deadline=self._began + until, watch=self._watch)
            finished = True
        finally:
            spent = self._clock() - self._began
            if not finished:
                self._journal.interrupt(spent)
        keys = [evaluator.row_key(each) for each in asked]
        missing = [
            key for key, each in zip(keys, asked, strict=True) if evaluator.row(each) is None
        ]
        return self._journal.add(keys, spent, keep, missing)

    def too_small(self, why: str) -> SelectionError:
        """The error for a budget that is too small; it suggests a larger one."""
        return budget_too_small(self.budget, self.spent, why)


def budget_too_small(budget: float, spent: float, why: str) -> SelectionError:
    """The error for a budget in seconds of which `spent` are gone; it suggests a larger one."""
    wanted = MORE * max(budget, spent)
    enough = next((each for each in BUDGETS if each >= wanted), round(wanted))
    return SelectionError(f'the budget is too small: {why}; give `budget="{_typed(enough)}"`')


def _typed(seconds: int) -> str:
    """As ``budget`` takes it."""
    return f"{-(-seconds // 60)}min" if seconds >= 60 else f"{seconds}s"
