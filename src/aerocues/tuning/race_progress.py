"""What a race tells while it goes on."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence

from aerocues.phrases import count, likelihood, spoken_seconds
from aerocues.progress import Activity, Progress, StageProgress
from aerocues.tuning.race import Round
from aerocues.tuning.session import budget_too_small

# Share of the budget that may be spent before the race: less than a tenth answers nothing.
LATEST = 0.9
# Steps that tell the pace.
FEWEST_DONE = 3


class Pace:
    """How long the rest of a stage takes, by its latest steps.

    A new total means that steps of another kind begin: these have a pace of their own. The first
    step also pays for what is loaded and compiled, so that it counts for nothing.
    """

    def __init__(self, clock: Callable[[], float]) -> None:
        self._clock = clock
        self._total = self._first = 0
        self._since = 0.0

    def to_go(self, done: int, total: int) -> float:
        """Seconds; 0 as long as too few steps tell."""
        now = self._clock()
        if total != self._total:
            self._total, self._first, self._since = total, done, now
        steps = done - self._first
        return (now - self._since) / steps * (total - done) if steps >= FEWEST_DONE else 0.0


class RaceProgress:
    """Turns what happens in a race into events.

    Parameters
    ----------
    progress : callable or None
        Called with each event.
    budget : float
        Seconds of the race.
    began : float
        From when on they count, by `clock`.
    clock : callable
        Returns seconds.
    strict : bool
        Whether a budget that will not do is refused; a race that has begun is only told again.
    """

    def __init__(
        self,
        progress: Progress | None,
        budget: float,
        began: float,
        clock: Callable[[], float] = time.monotonic,
        *,
        strict: bool = True,
    ) -> None:
        self._progress, self._budget = progress, budget
        self._began, self._clock, self._strict = began, clock, strict
        self._stage = self._of("reading images", "images")
        self.read = self._stage.count

    def _of(self, stage: str, unit: str, total: int = 0) -> StageProgress:
        ends = self._began + self._budget
        return StageProgress(self._progress, stage, unit, total=total, ends=ends)

    def note(self, message: str) -> None:
        """A line to keep."""
        self._stage.say(message)

    def resumed(self, spent: float) -> None:
        """So many seconds were spent before an interruption."""
        self._began -= spent

    def looking(self, pairs: int) -> None:
        """It is looked which of so many pairs show the same things."""
        self._stage = self._of("comparing images", "pairs")
        what = f"looking which of {count(pairs, 'pair')} show the same things"
        self._stage.tell(message=what, standing=what)

    def preparing(self, stage: str, unit: str, *, alike: bool = True) -> Callable[[int, int], None]:
        """Tells of a stage before the race how many are done.

        Parameters
        ----------
        stage, unit : str
        alike : bool
            Whether steps take about as long as each other; else their pace is believed only when
            half of them are done.

        Raises
        ------
        SelectionError
            From what it returns: as soon as the stage will not leave time for a race.
        """
        told, pace = self._of(stage, unit), Pace(self._clock)
        told.tell(standing=stage)
        self._refuse_late(stage, 0.0)

        def step(done: int, total: int) -> None:
            told.tell(done=done, total=total, standing="")
            to_go = pace.to_go(done, total)
            self._refuse_late(stage, to_go if alike or 2 * done >= total else 0.0)

        return step

    def _refuse_late(self, stage: str, to_go: float) -> None:
        spent = self._clock() - self._began
        if self._strict and spent + to_go > LATEST * self._budget:
            late = spoken_seconds(math.ceil(spent + to_go))
            why = f"{stage} is not over before {late}, which leaves too little for the race"
            raise budget_too_small(self._budget, spent + to_go, why)

    def racing(self, combinations: int, pairs: int) -> None:
        """The race begins."""
        total = combinations * pairs
        self._stage = self._of("racing", "measurements", total)
        what = f"{count(combinations, 'combination')} race on {count(pairs, 'pair')}"
        self._stage.tell(message=what, standing=what)

    def round(self, finished: Round) -> None:
        """A round is over."""
        standing = (
            f"{finished.ranked[0]} leads ({likelihood(finished.probability)}), "
            f"{finished.contenders} still in the race"
        )
        share = min(finished.spent / self._budget, 1.0)
        self._stage.tell(done=finished.measured, share=share, standing=standing)

    def watch(self, activities: Sequence[Activity]) -> None:
        """What the workers are doing."""
        self._stage.watch(activities)
