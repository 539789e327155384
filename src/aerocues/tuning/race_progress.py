"""What a race tells while it goes on."""

from __future__ import annotations

from collections.abc import Sequence

from aerocues.phrases import count, likelihood, spoken_seconds
from aerocues.progress import Activity, Progress, StageProgress
from aerocues.tuning.race import Round


class RaceProgress:
    """Turns what happens in a race into events.

    Parameters
    ----------
    progress : callable or None
        Called with each event.
    budget : float
        Seconds of the race.
    """

    def __init__(self, progress: Progress | None, budget: float) -> None:
        self._progress, self._budget = progress, budget
        self._stage = StageProgress(progress, "reading images", "images")
        self._surveyed: StageProgress | None = None
        self._reached: StageProgress | None = None
        self.read = self._stage.count

    def looking(self, pairs: int) -> None:
        """It is looked which of so many pairs show the same things."""
        self._stage = StageProgress(self._progress, "comparing images", "pairs")
        what = f"looking which of {count(pairs, 'pair')} show the same things"
        self._stage.tell(message=what, standing=what)

    def surveyed(self, done: int, total: int) -> None:
        """So many images and pairs of a flight were looked at."""
        if not done or self._surveyed is None:
            self._surveyed = StageProgress(
                self._progress, "surveying the flight", "images and pairs"
            )
        self._surveyed.count(done, total)

    def reached(self, done: int, total: int) -> None:
        """The thresholds of so many detectors were set."""
        if self._reached is None:
            self._reached = StageProgress(self._progress, "setting thresholds", "detectors")
        self._reached.count(done, total)

    def racing(self, combinations: int, pairs: int) -> None:
        """The race begins."""
        total = combinations * pairs
        self._stage = StageProgress(self._progress, "racing", "measurements", total=total)
        what = f"{count(combinations, 'combination')} race on {count(pairs, 'pair')}"
        self._stage.tell(message=what, standing=what)

    def round(self, finished: Round) -> None:
        """A round is over."""
        standing = (
            f"{spoken_seconds(finished.spent)} of {spoken_seconds(self._budget)}: "
            f"{count(finished.measured, 'measurement')}, {finished.leader} leads "
            f"({likelihood(finished.probability)}), {finished.contenders} may still be among the "
            "best"
        )
        share = min(finished.spent / self._budget, 1.0)
        self._stage.tell(done=finished.measured, share=share, standing=standing)

    def watch(self, activities: Sequence[Activity]) -> None:
        """What the workers are doing."""
        self._stage.watch(activities)
